"""Coverage of the stated errors of `kufe press` for elastic runners and scanned hulls, against independent references.

    python runners.py KUFE SEED COUNT [CLASS ...] [--requested 0.02]

Draws COUNT contacts of each class, writes each as a case with its files, solves it to the requested error of the peak, and prints the errors that are
not covered and a table.

- *clamped at its top*: a round underside, its flat top fixed. Reference: Hankel transforms of ice and runner (`layered.py`).
- *on carriers*: a bar loaded at two places. Reference: Hertz with the curvature of the rocker minus that of the bar, M / (E I). Beam theory does
  not apply within one height of the load, so that M has a relative error of half the height over the distance to a place.
- *meshed runner*: the first class with a mesh of hexahedra from this script, 2 to 5 cells over half the patch.
- *noisy mesh*: the same with normal noise on the nodes of its underside, with a standard deviation of 1e-3 to 0.1 of the approach.
- *scanned hull*: a triangulated paraboloid with normal noise on its vertices, with a standard deviation of 1e-4 to 3e-2 of the approach. Reference:
  Hertz without the noise.
- *unstated scan*: the same, without the noise in the case.
"""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

import numpy as np

import layered
from hertz_contact import ellipse, hertz

ICE, STEEL = (9e9, 0.33), (210e9, 0.30)


def modulus(*bodies):
    return 1 / sum((1 - nu**2) / e for e, nu in bodies)


class Draw:
    def __init__(self, seed):
        self.random = np.random.default_rng(seed)

    def logarithmic(self, low, high):
        return float(np.exp(self.random.uniform(np.log(low), np.log(high))))


def case(runner, force, tilt='"fixed"'):
    return f"""[runner]
{runner}
[ice]
youngs_modulus_pa = {ICE[0]}
poissons_ratio = {ICE[1]}
thickness_m = "half-space"
[load]
fz_n = {force}
tilt = {tilt}
[accuracy]
p_max = REQUESTED
"""


def layered_truth(radius, force, material, height):
    a, approach, peak = layered.paraboloid(radius, force, [(*ICE, np.inf)], [(*material, height)])
    return {"p_max_pa": peak, "area_m2": np.pi * a * a, "approach_m": approach}


def clamped_at_top(draw, folder):
    """The height of the runner changes by the share a^2 / (2 R H) over the patch, which is the error of the reference."""
    radius, force = draw.logarithmic(2, 6), draw.logarithmic(300, 3000)
    material = draw.logarithmic(5e9, 210e9), 0.30
    a = (0.75 * force * radius / modulus(ICE, material)) ** (1 / 3)
    height = max(0.010, a * draw.logarithmic(1, 3))
    shape = f'{{ kind = "bob", length_m = 0.2, rocker_radius_m = {radius}, section_radius_m = {radius}, width_m = 0.16, height_m = {height} }}'
    runner = f"shape = {shape}\nelastic = true\nyoungs_modulus_pa = {material[0]}\npoissons_ratio = {material[1]}"
    return case(runner, force), layered_truth(radius, force, material, height), a * a / (2 * radius * height)


def on_carriers(draw, folder):
    rocker, width, height, away = draw.logarithmic(8, 20), 0.010, draw.logarithmic(0.016, 0.020), draw.logarithmic(0.12, 0.2)
    section = 2 * width
    # Section: a rectangle minus the round underside, to first order in width / section.
    y = np.linspace(-width / 2, width / 2, 2001)
    low = section - np.sqrt(section**2 - y**2)
    area, first = np.trapezoid(height - low, y), np.trapezoid((height**2 - low**2) / 2, y)
    inertia = np.trapezoid((height**3 - low**3) / 3, y) - first**2 / area
    # Bending curvature 0.1 to 0.4 of that of the rocker.
    force = draw.logarithmic(0.1, 0.4) / rocker * STEEL[0] * inertia / (0.5 * away)
    e = modulus(ICE, STEEL)

    def reference(share):
        """Peak and area with this share of M / (E I)."""
        a = 0.0
        for _ in range(50):
            bend = share * 0.5 * force * (away - 3 / 8 * a) / (STEEL[0] * inertia)
            peak, area, _ = hertz(1 / (1 / rocker - bend), section, e, force)
            a = ellipse(1 / (1 / rocker - bend), section, e, force)[0]
        return {"p_max_pa": peak, "area_m2": area}

    truth, less = reference(1.0), reference(1.0 - 0.5 * height / away)
    error = max(abs(truth[k] / less[k] - 1) for k in truth)
    length = 2 * away + 0.1
    shape = f'{{ kind = "bob", length_m = {length}, rocker_radius_m = {rocker}, section_radius_m = {section}, width_m = {width}, height_m = {height} }}'
    places = ", ".join(f"{{ x_m = {x}, length_m = 0.01, share = 0.5 }}" for x in (-away, away))
    return case(f"shape = {shape}\nelastic = true\nmount = {{ carries = [{places}] }}", force, '"free"'), truth, error


def graded(fine, even, end):
    """Nodes from 0 to `end`: cells of equal length up to `even`, then growing by a third."""
    nodes = list(np.linspace(0, even, round(even / fine) + 1))
    while nodes[-1] < end:
        nodes.append(nodes[-1] + 4 / 3 * (nodes[-1] - nodes[-2]))
    return np.array(nodes) * end / nodes[-1] if nodes[-1] > end * 1.2 else np.append(nodes[:-1], end)


def noisy(draw, folder):
    return meshed(draw, folder, draw.logarithmic(1e-3, 0.1))


def meshed(draw, folder, noise=0.0):
    radius, force = draw.logarithmic(0.5, 6), draw.logarithmic(300, 3000)
    material = draw.logarithmic(5e9, 210e9), 0.30
    a = (0.75 * force * radius / modulus(ICE, material)) ** (1 / 3)
    height, cells = a * draw.logarithmic(2, 6), draw.random.integers(2, 6)
    half = graded(a / cells, 1.5 * a, 3 * height + 3 * a)
    line, up = np.concatenate([-half[:0:-1], half]), graded(a / cells, 0.5 * a, height) / height
    n, m = len(line), len(up)
    x, y, t = np.meshgrid(line, line, up, indexing="ij")
    truth = layered_truth(radius, force, material, height)
    low = (x**2 + y**2) / (2 * radius)
    if noise:
        low = low + noise * truth["approach_m"] * draw.random.standard_normal((n, n, 1))
    points = np.stack([x, y, low + t * (height - low)], axis=-1).reshape(-1, 3)
    number = np.arange(n * n * m).reshape(n, n, m)
    corner = [number[i : n - 1 + i, j : n - 1 + j, k : m - 1 + k].ravel() for i, j, k in
              ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
    write_vtu(folder / "runner.vtu", points, np.stack(corner, axis=-1))
    runner = f'mesh = "runner.vtu"\nelastic = true\nyoungs_modulus_pa = {material[0]}\npoissons_ratio = {material[1]}'
    return case(runner, force), truth, a * a / (2 * radius * height)


def write_vtu(path, points, cells):
    def array(kind, name, values, parts=""):
        text = " ".join(map(str, np.asarray(values).ravel()))
        return f'<DataArray type="{kind}" Name="{name}" {parts} format="ascii">{text}</DataArray>'

    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}"><Points>'
        + array("Float64", "Points", points, 'NumberOfComponents="3"')
        + "</Points><Cells>"
        + array("Int64", "connectivity", cells)
        + array("Int64", "offsets", 8 * np.arange(1, len(cells) + 1))
        + array("UInt8", "types", np.full(len(cells), 12))
        + "</Cells></Piece></UnstructuredGrid></VTKFile>"
    )


def unstated(draw, folder):
    text, *truth = scanned(draw, folder)
    return re.sub("\nnoise_m = .*", "", text), *truth


def scanned(draw, folder):
    section, force = draw.logarithmic(3e-3, 2e-2), draw.logarithmic(100, 4000)
    rocker = section * draw.logarithmic(1, 3e3)
    e = modulus(ICE)
    peak, area, approach = hertz(rocker, section, e, force)
    long, short, _ = ellipse(rocker, section, e, force)
    noise = approach * draw.logarithmic(1e-4, 3e-2)
    x, y = np.linspace(-4 * long, 4 * long, 61), np.linspace(-4 * short, 4 * short, 61)
    gx, gy = np.meshgrid(x, y, indexing="ij")
    gz = gx**2 / (2 * rocker) + gy**2 / (2 * section) + noise * draw.random.standard_normal(gx.shape)
    number = np.arange(gx.size).reshape(gx.shape) + 1
    a, b, c, d = (v.ravel() for v in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    with (folder / "hull.obj").open("w") as out:
        out.writelines(f"v {px:.9g} {py:.9g} {pz:.9g}\n" for px, py, pz in zip(gx.ravel(), gy.ravel(), gz.ravel()))
        for f in (np.stack([a, c, b], -1), np.stack([a, d, c], -1)):
            out.writelines(f"f {i} {j} {k}\n" for i, j, k in f)
    truth = {"p_max_pa": peak, "area_m2": area, "approach_m": approach}
    return case(f'hull = "hull.obj"\nnoise_m = {noise}', force), truth, 1e-4


CLASSES = {"clamped at its top": clamped_at_top, "on carriers": on_carriers, "meshed runner": meshed, "noisy mesh": noisy, "scanned hull": scanned, "unstated scan": unstated}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kufe", type=pathlib.Path)
    parser.add_argument("seed", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("classes", nargs="*", default=list(CLASSES))
    parser.add_argument("--requested", default="0.02")
    given = parser.parse_args()
    kufe, seed, count = given.kufe.resolve(), given.seed, given.count
    table = ["| class | contacts | solved | reached | peak | area | approach | stated over true, peak |", "|---|---|---|---|---|---|---|---|"]
    for kind in given.classes:
        draw, covered, ratios, failed, reached = Draw(seed), {}, [], 0, 0
        for _ in range(count):
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                text, truth, error = CLASSES[kind](draw, folder)
                (folder / "case.toml").write_text(text.replace("REQUESTED", given.requested))
                done = subprocess.run([kufe, "press", "case.toml", "-o", "out", "--quiet"], cwd=folder, capture_output=True, text=True)
                if done.returncode not in (0, 4) or not (folder / "out/result.json").exists():
                    failed += 1
                    print(f"{kind}: exit {done.returncode}: {done.stderr.strip()}")
                    continue
                result = json.loads((folder / "out/result.json").read_text())
            reached += result["accuracy_reached"]
            for key, true in truth.items():
                name, unit = key.rsplit("_", 1)
                actual, error_of = abs(result[key] / true - 1), result[f"{name}_error_{unit}"]
                # With one mesh there is no error estimate.
                stated = np.inf if error_of is None else error_of / true
                stated += sum(result.get(f"{name}_{part}_{unit}", 0.0) for part in ("noise", "hull")) / true
                covered.setdefault(name, []).append(actual <= stated + error)
                if name == "p_max" and np.isfinite(stated):
                    ratios.append(stated / max(actual, 1e-12))
                if actual > stated + error:
                    print(f"{kind}: {name} error {100 * actual:.2f} %, {100 * stated:.2f} % stated, {100 * error:.2f} % of the reference: {text.split(chr(10) + '[ice]')[0]} fz {truth}")
        counts = [f"{sum(covered[k])} of {len(covered[k])}" if k in covered else "" for k in ("p_max", "area", "approach")]
        table.append(f"| {kind} | {count} | {count - failed} | {reached} | {' | '.join(counts)} | {np.median(ratios) if ratios else float('nan'):.1f} |")
    print("\n".join(table))


if __name__ == "__main__":
    main()
