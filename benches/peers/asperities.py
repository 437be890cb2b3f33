"""Rough ice under a ball, kufe and Tamaas (`dcfft`, so not periodic): contact area, peak, time and memory over the nodes that touch.

    python benches/peers/asperities.py target/release/kufe [POINTS ...]

The map has POINTS x POINTS heights; the contact grows with it, and with it the nodes. Both programs run in processes of their
own, Tamaas on a square of the last grid's cells around the contact. Prints a Markdown table; exit code 1 where peaks or areas
differ by over 3 %.
"""
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

E, NU, PITCH = 9.0e9, 0.33, 1e-5
# Of a map of 256 points; radii grow with its side, loads with its area, so that the pressure stays.
RADIUS, LOAD = 0.14, 94.0
POINTS = [160, 330, 720]


def rough(points):
    """Self-affine heights [m] of waves from 80 to 640 µm, Hurst exponent 0.8, slope 0.02 rms."""
    k = np.fft.fftfreq(points, PITCH)
    k = np.hypot(k[:, None], k[None, :])
    k[0, 0] = 1.0
    amplitude = np.where((k >= 1 / 6.4e-4) & (k <= 1 / 8e-5), k**-1.8, 0.0)
    noise = np.random.default_rng(1).standard_normal((points, points))
    heights = np.fft.ifft2(np.fft.fft2(noise) * amplitude).real
    slopes = np.gradient(heights, PITCH)
    return heights * 0.02 / np.sqrt((slopes[0] ** 2 + slopes[1] ** 2).mean())


def weights(places, points):
    """Keys's cubic convolution: values at places from those at the points, a matrix."""
    u = np.clip(places / PITCH + (points - 1) / 2, 0, points - 1)
    i = np.minimum(u.astype(int), points - 2)
    t = u - i
    of = [t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)]
    matrix = np.zeros((len(places), points))
    for k, weight in zip([np.maximum(i - 1, 0), i, i + 1, np.minimum(i + 2, points - 1)], of):
        np.add.at(matrix, (np.arange(len(places)), k), weight)
    return matrix


def tamaas(points, side, cells):
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    at = (np.arange(cells) + 0.5) * side / cells - side / 2
    interpolated = weights(at, points)
    radius, load = RADIUS * points / 256, LOAD * (points / 256) ** 2
    ball = (at[:, None] ** 2 + at[None, :] ** 2) / (2 * radius)
    surface = np.ascontiguousarray(interpolated @ rough(points) @ interpolated.T - ball)
    model = tm.Model(tm.model_type.basic_2d, [side, side], [cells, cells])
    model.E, model.nu = E, NU
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tm.PolonskyKeerRey(model, surface, 1e-8)
    solver.setIntegralOperator("dcfft")
    solver.solve(load / side**2)
    touching = int((model.traction > 0).sum())
    print(json.dumps({"p_max": model.traction.max(), "area": touching * (side / cells) ** 2, "nodes": touching}))


def measured(command):
    """Output, wall and processor time [s] and peak memory [MB] of a process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.perf_counter()
    output = subprocess.run(["/usr/bin/time", "-f", "%M", *map(str, command)], capture_output=True, text=True)
    if output.returncode:
        raise SystemExit(output.stderr)
    wall, after = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return output.stdout, wall, processor, int(output.stderr.split()[-1]) / 1024


def kufe(command, folder, points):
    heights = rough(points)
    at = (np.arange(points) - (points - 1) / 2) * PITCH
    rows = (f"{at[i]:.9e},{at[j]:.9e},{heights[i, j]:.9e}" for j in range(points) for i in range(points))
    (folder / "ice.csv").write_text("x_m,y_m,z_m\n" + "\n".join(rows) + "\n")
    radius = RADIUS * points / 256
    (folder / "case.toml").write_text(
        f'[runner]\nshape = {{ kind = "paraboloid", rocker_radius_m = {radius}, section_radius_m = {radius} }}\n'
        f'[ice]\nyoungs_modulus_pa = {E}\npoissons_ratio = {NU}\nthickness_m = "half-space"\nsurface = "ice.csv"\n'
        f'[load]\nfz_n = {LOAD * (points / 256) ** 2}\ntilt = "fixed"\n[accuracy]\np_max = 0.02\n'
    )
    _, *cost = measured([command, "press", folder / "case.toml", "-o", folder / "out", "--quiet"])
    return json.loads((folder / "out/result.json").read_text()), cost


def main():
    if sys.argv[1] == "--tamaas":
        return tamaas(int(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4]))
    print("### Rough ice under a ball: kufe and Tamaas\n")
    print("| touching nodes, kufe | area, kufe | area, Tamaas | p_max, kufe | p_max, Tamaas | kufe: wall, processor, memory | Tamaas |")
    print("|---|---|---|---|---|---|---|")
    good = True
    for points in [int(word) for word in sys.argv[2:]] or POINTS:
        with tempfile.TemporaryDirectory() as folder:
            result, cost = kufe(sys.argv[1], Path(folder), points)
        nodes = result["history"][-1]["contact_nodes"]
        size = np.sqrt(result["area_m2"] / nodes)
        side = 1.06 * max(result["length_m"], result["width_m"])
        cells = int(np.ceil(side / size))
        output, *theirs = measured([sys.executable, __file__, "--tamaas", points, side, cells])
        other = json.loads(output)
        area, p_max = result["area_m2"], result["p_max_pa"]
        good &= abs(area / other["area"] - 1) < 0.03 and abs(p_max / other["p_max"] - 1) < 0.03
        costs = [f"{wall:.2f} s, {processor:.2f} s, {memory:.0f} MB" for wall, processor, memory in (cost, theirs)]
        print(f"| {nodes} | {1e6 * area:.4f} ± {1e6 * result['area_error_m2']:.4f} mm² | {1e6 * other['area']:.4f} mm² "
              f"| {p_max / 1e6:.1f} ± {result['p_max_error_pa'] / 1e6:.1f} MPa | {other['p_max'] / 1e6:.1f} MPa | {costs[0]} | {costs[1]} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
