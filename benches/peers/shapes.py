"""Gaps that are no paraboloid, kufe beside Tamaas (`dcfft`, so not periodic): peak pressure and pressure map.

    python benches/peers/shapes.py target/release/fields

Prints a Markdown table; exit code 1 where p_max differs by over 1 % or the maps by over 2 % (L2).
"""
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import tamaas as tm
from scipy.interpolate import RegularGridInterpolator

E, NU, FORCE, ROCKER, SECTION = 9.0e9, 0.33, 1000.0, 30.0, 0.005


def across(y):
    return y**2 / (2 * SECTION)


def ends(x):
    return 0.5 * np.maximum(abs(x) - 0.08, 0) ** 2


# Height, and Tamaas' window and points (sized by hand after a look at kufe's patch).
SHAPES = {
    "conformal": (lambda x, y: across(y) + ends(x), (0.22, 3.6e-4), (1024, 80)),
    "two-ended": (lambda x, y: across(y) + ends(x) - x**2 / (2 * ROCKER), (0.22, 6e-4), (2048, 80)),
    "wavy": (lambda x, y: across(y) + x**2 / (2 * ROCKER) + 4e-6 * (1 - np.cos(2 * np.pi * x / 0.02)), (0.08, 5e-4), (1024, 80)),
    "worn": (lambda x, y: across(np.maximum(abs(y) - 5e-5, 0)) + x**2 / (2 * ROCKER), (0.06, 4e-4), (256, 160)),
}


def centres(length, count):
    """Points of the grid, one of them at 0."""
    return (np.arange(count) - count // 2) * length / count


def tamaas(height, window, points):
    x, y = (centres(length, count) for length, count in zip(window, points))
    surface = -np.ascontiguousarray(height(x[:, None], y[None, :]))
    model = tm.Model(tm.model_type.basic_2d, list(window), list(points))
    model.E, model.nu = E, NU
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tm.PolonskyKeerRey(model, surface, 1e-9)
    solver.setIntegralOperator("dcfft")
    begun = time.perf_counter()
    solver.solve(FORCE / np.prod(window))
    pressure = model.traction.copy()
    border = max(pressure[0].max(), pressure[-1].max(), pressure[:, 0].max(), pressure[:, -1].max())
    if border > 0:
        raise SystemExit(f"the window {window} m is too small: {border} Pa at its border")
    return x, y, pressure, time.perf_counter() - begun


def main():
    tm.set_log_level(tm.LogLevel.error)
    fields = sys.argv[1]
    good = True
    print("| gap | p_max, kufe | p_max, Tamaas | differ | maps differ (L2) | kufe | Tamaas | points |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, (height, window, points) in SHAPES.items():
            said = subprocess.run([fields, "shape", name, folder], check=True, capture_output=True, text=True).stdout
            p_max, _, seconds, _, _ = map(float, said.split())
            table = np.loadtxt(Path(folder) / f"{name}.csv", delimiter=",")
            x, y, pressure, theirs = tamaas(height, window, points)
            mine = RegularGridInterpolator((table[1:, 0], table[0, 1:]), table[1:, 1:], bounds_error=False, fill_value=0.0)
            mine = mine(tuple(np.meshgrid(y, x, indexing="ij"))).T
            peak = p_max / pressure.max() - 1
            maps = np.linalg.norm(mine - pressure) / np.linalg.norm(pressure)
            good &= abs(peak) <= 0.01 and maps <= 0.02
            print(f"| {name} | {p_max / 1e6:.2f} MPa | {pressure.max() / 1e6:.2f} MPa | {100 * peak:+.2f} % | {100 * maps:.2f} % "
                  f"| {seconds:.2f} s | {theirs:.2f} s | {points[0]} x {points[1]} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
