"""Gaps that are no paraboloid, kufe and Tamaas (`dcfft`, so not periodic): peak pressure and pressure map.

    python benches/peers/shapes.py target/release/kufe [SHAPE ...]

Each shape is a case of `kufe press`: a paraboloid on ice with waves or a measured surface. Maps are compared as means over
Tamaas' cells: its pressures are such means, and `pressure.exr` is averaged over them. Prints a Markdown table; exit code 1
where p_max differs by over 1 %; maps over 2 % (L2) are marked.
"""
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenEXR
import tamaas as tm
from scipy.interpolate import RegularGridInterpolator

E, NU, FORCE, ROCKER, SECTION = 9.0e9, 0.33, 1000.0, 30.0, 0.005
WAVES = 'waviness = { amplitude_m = 4.0e-6, wavelength_m = 0.02 }'
# Requested relative error of kufe's peak pressure, whose last mesh is the map's; the conformal and the worn peak are not had to 0.1 %.
ACCURACY = {"conformal": 0.003, "worn": 0.005}
FINE = 0.001
# Points along and across in a cell over which a map is averaged.
INNER = 6


def across(y):
    return y**2 / (2 * SECTION)


def ends(x):
    return 0.5 * np.maximum(abs(x) - 0.08, 0) ** 2


LONG = (np.linspace(-0.3, 0.3, 1201), np.array([-0.01, 0.0, 0.01]))
WIDE = (np.array([-0.3, 0.0, 0.3]), np.linspace(-5e-4, 5e-4, 1001))

# Gap, and Tamaas' window and points (sized by hand after a look at kufe's patch); then kufe's rocker radius and what the ice
# adds to it: waves, or a height map with its points along and across.
SHAPES = {
    "conformal": (lambda x, y: across(y) + ends(x), (0.22, 3.6e-4), (1024, 80), "inf", (lambda x, y: -ends(x), LONG)),
    "two-ended": (
        lambda x, y: across(y) + ends(x) - x**2 / (2 * ROCKER), (0.22, 6e-4), (2048, 80), "inf",
        (lambda x, y: x**2 / (2 * ROCKER) - ends(x), LONG),
    ),
    "wavy": (
        lambda x, y: across(y) + x**2 / (2 * ROCKER) + 4e-6 * (1 - np.cos(2 * np.pi * x / 0.02)), (0.08, 5e-4), (1024, 80),
        f"{ROCKER}", WAVES,
    ),
    "worn": (
        lambda x, y: across(np.maximum(abs(y) - 5e-5, 0)) + x**2 / (2 * ROCKER), (0.06, 4e-4), (256, 160), f"{ROCKER}",
        (lambda x, y: across(y) - across(np.maximum(abs(y) - 5e-5, 0)), WIDE),
    ),
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


def kufe(command, folder, rocker, ice, accuracy):
    """result.json and the map of one shape."""
    if not isinstance(ice, str):
        height, (xs, ys) = ice
        rows = [f"{x:.9g},{y:.9g},{height(x, y):.12e}" for y in ys for x in xs]
        (folder / "ice.csv").write_text("x_m,y_m,z_m\n" + "\n".join(rows) + "\n")
        ice = 'surface = "ice.csv"'
    (folder / "case.toml").write_text(
        f"[runner]\nshape = {{ kind = \"paraboloid\", rocker_radius_m = {rocker}, section_radius_m = {SECTION} }}\n"
        f"[ice]\nyoungs_modulus_pa = {E}\npoissons_ratio = {NU}\nthickness_m = \"half-space\"\n{ice}\n"
        f"[load]\nfz_n = {FORCE}\n[accuracy]\np_max = {accuracy}\n"
    )
    out = folder / "out"
    subprocess.run([command, "press", folder / "case.toml", "-o", out, "--quiet"], check=True, stderr=subprocess.DEVNULL)
    file = OpenEXR.File(str(out / "pressure.exr"), separate_channels=True)
    head, pressure = file.header(), file.channels()["p"].pixels.astype(float)
    axis = lambda name, count: float(np.ravel(head[f"origin_{name}_m"])[0]) + float(np.ravel(head[f"pixel_{name}_m"])[0]) * np.arange(count)
    y, x = (axis(name, count) for name, count in zip("yx", pressure.shape))
    return json.loads((out / "result.json").read_text()), RegularGridInterpolator((y, x), pressure, bounds_error=False, fill_value=0.0)


def cell_means(at, x, y):
    """Means over the cells around the points x, y."""
    inner = (np.arange(INNER) - (INNER - 1) / 2) / INNER
    xs, ys = ((nodes[:, None] + inner * (nodes[1] - nodes[0])).ravel() for nodes in (x, y))
    values = at(tuple(np.meshgrid(ys, xs, indexing="ij"))).T
    return values.reshape(len(x), INNER, len(y), INNER).mean(axis=(1, 3))


def main():
    tm.set_log_level(tm.LogLevel.error)
    command = sys.argv[1]
    good = True
    print("### Gaps that are no paraboloid: kufe and Tamaas\n")
    print("| gap | p_max, kufe | p_max, Tamaas | differ | maps differ (L2) | kufe | Tamaas | points |")
    print("|---|---|---|---|---|---|---|---|")
    for name in sys.argv[2:] or SHAPES:
        height, window, points, rocker, ice = SHAPES[name]
        with tempfile.TemporaryDirectory() as folder:
            result, at = kufe(command, Path(folder), rocker, ice, ACCURACY.get(name, FINE))
        x, y, pressure, theirs = tamaas(height, window, points)
        p_max = result["p_max_pa"]
        peak = p_max / pressure.max() - 1
        maps = np.linalg.norm(cell_means(at, x, y) - pressure) / np.linalg.norm(pressure)
        good &= bool(abs(peak) <= 0.01)
        mark = "" if maps <= 0.02 else " (over 2)"
        print(f"| {name} | {p_max / 1e6:.2f} MPa | {pressure.max() / 1e6:.2f} MPa | {100 * peak:+.2f} % | {100 * maps:.2f} %{mark} "
              f"| {result['seconds']:.2f} s | {theirs:.2f} s | {points[0]} x {points[1]} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
