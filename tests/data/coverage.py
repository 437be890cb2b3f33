"""Random contacts of several classes with reference peak pressure, area and approach, without finite elements.

    python coverage.py [SEED [COUNT CLASS...]] > coverage.csv

With classes: COUNT contacts of each of them only.

References:

- rigid, two elastic bodies, offset loads (which only shift the patch): Hertz's closed form
- round hulls on one or two layers over a rigid bed: Hankel transforms (`layered.py`)
- other gaps, yielding ice, worn flats: rectangles of uniform pressure (A. E. H. Love, 1929), with displacements by convolution, on two grids; `truth` is
  their relative difference
- peaks at the ends of a runner, narrow flats: `slender.csv`
"""
import csv
import pathlib
import sys

import numpy as np

import layered
from hertz_contact import hertz

E, NU = 9e9, 0.33
STEEL = 210e9, 0.30
COLUMNS = (
    "class rocker_radius_m section_radius_m quartic_1pm3 fz_n offset_x_m offset_y_m thickness_m bed_youngs_modulus_pa"
    " bed_thickness_m steel hardness_pa worn_m worn_edge_m curvature_1pm p_max_pa area_m2 approach_m truth"
).split()
SEED = int(sys.argv[1]) if sys.argv[1:] else 20261122
CLASSES = sys.argv[3:]
random = np.random.default_rng(SEED)


def modulus(steel=False):
    soft = (1 - NU**2) / E + ((1 - STEEL[1] ** 2) / STEEL[0] if steel else 0)
    return 1 / soft


def logarithmic(low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


class Rectangles:
    """Half-space with nx x ny rectangles of uniform pressure over [-x, x] x [-y, y]."""

    def __init__(self, shape, x, y, contact_modulus):
        self.shape, self.double = shape, [2 * n for n in shape]
        sizes = self.dx, self.dy = 2 * x / shape[0], 2 * y / shape[1]
        self.x, self.y = ((np.arange(n) + 0.5) * d - reach for n, d, reach in zip(shape, sizes, (x, y)))
        places = (np.concatenate([np.arange(n), np.arange(-n, 0)]) * d for n, d in zip(shape, sizes))
        gx, gy = np.meshgrid(*places, indexing="ij")

        def corner(a, b):
            return a * np.arcsinh(b / np.abs(a)) + b * np.arcsinh(a / np.abs(b))

        love = sum(
            s * t * corner(gx + s * self.dx / 2, gy + t * self.dy / 2) for s in (1, -1) for t in (1, -1)
        )
        self.kernel = np.fft.rfft2(love / (np.pi * contact_modulus))
        waves = np.fft.fftfreq(shape[0], self.dx), np.fft.rfftfreq(shape[1], self.dy)
        self.wave_number = np.hypot(*np.meshgrid(*waves, indexing="ij"))
        self.wave_number[0, 0] = self.wave_number.ravel()[1:].min()

    def displacement(self, pressure):
        spectrum = np.fft.rfft2(pressure, self.double) * self.kernel
        return np.fft.irfft2(spectrum, self.double)[: self.shape[0], : self.shape[1]]

    def solve(self, inside, side, start):
        """Conjugate gradients on the rectangles inside, preconditioned by the stiffness of the half-space in Fourier space."""
        x = np.where(inside, start, 0.0)
        r = np.where(inside, side - self.displacement(x), 0.0)
        p, rho = 0.0, 1.0
        first = (np.where(inside, side, 0) ** 2).sum()
        while (r * r).sum() > 1e-18 * first:
            z = np.where(inside, np.fft.irfft2(np.fft.rfft2(r) * self.wave_number, self.shape), 0.0)
            rho, before = (r * z).sum(), rho
            p = z + rho / before * p
            q = np.where(inside, self.displacement(p), 0.0)
            step = rho / (p * q).sum()
            x += step * p
            r -= step * q
        return x

    def press(self, gap, force, hardness):
        """Pressure and approach by an active set of open, closed and yielding rectangles."""
        cell = self.dx * self.dy
        depth = np.sort(gap.ravel())[int(0.3 * gap.size)]
        inside, full = gap < depth, np.zeros(gap.shape, bool)
        ones, shape = np.zeros(gap.shape), np.zeros(gap.shape)
        for _ in range(60):
            load = np.where(full, min(hardness, 1e30), 0.0)
            ones = self.solve(inside, np.ones(gap.shape), ones)
            shape = self.solve(inside, gap + self.displacement(load), shape)
            approach = (force / cell - load.sum() + shape.sum()) / ones.sum()
            pressure = np.where(inside, approach * ones - shape, load)
            opening = gap + self.displacement(pressure) - approach
            slack = 1e-9 * approach
            new_full = (inside & (pressure > hardness)) | (full & (opening <= slack))
            new_inside = (inside & (pressure > 0) & (pressure <= hardness)) | (full & (opening > slack)) | (~inside & ~full & (opening < -slack))
            if (new_full == full).all() and (new_inside == inside).all():
                return pressure, approach
            inside, full = new_inside, new_full
        raise SystemExit("the contact set does not converge")


def highest(pressure):
    """Peak pressure, interpolated by parabolas through the neighbours of the largest value on each axis."""
    i, j = np.unravel_index(pressure.argmax(), pressure.shape)
    top = pressure[i, j]
    for before, after in ((pressure[i - 1, j], pressure[i + 1, j]), (pressure[i, j - 1], pressure[i, j + 1])):
        slope, curvature = (after - before) / 2, after - 2 * pressure[i, j] + before
        top -= slope**2 / (2 * curvature)
    return top


def boundary(gap, force, hardness, reach, coarse=(64, 64)):
    """Peak, area, approach and relative difference of two grids."""
    found = []
    for finer in (1, 2):
        grid = Rectangles([finer * n for n in coarse], *reach, modulus())
        pressure, approach = grid.press(gap(*np.meshgrid(grid.x, grid.y, indexing="ij")), force, hardness)
        top = highest(pressure) if np.isinf(hardness) else pressure.max()
        area = (pressure > 0).sum() * grid.dx * grid.dy
        found.append((top, area, approach))
    coarse, fine = found
    return (*fine, max(abs(fine[0] / coarse[0] - 1), abs(fine[2] / coarse[2] - 1)))


def reach_of(gap, force, reach):
    """Half lengths of a rectangle slightly larger than the contact, from a coarse grid."""
    reach = np.array(reach)
    while True:
        grid = Rectangles((24, 128), *reach, modulus())
        pressure, _ = grid.press(gap(*np.meshgrid(grid.x, grid.y, indexing="ij")), force, np.inf)
        ends = [np.abs(line[(pressure > 0).any(1 - axis)]).max() for axis, line in enumerate((grid.x, grid.y))]
        found = np.array(ends) + np.array([grid.dx, grid.dy]) / 2
        if (found < 0.98 * reach).all():
            return 1.06 * found
        reach = np.where(found < 0.98 * reach, reach, 1.4 * reach)


def arc(radius, x):
    return x * x / (radius + np.sqrt((radius - x) * (radius + x)))


def row(kind, rocker, section, force, figures, truth=1e-6, **more):
    values = dict.fromkeys(COLUMNS, 0)
    values.update(
        {"class": kind, "rocker_radius_m": rocker, "section_radius_m": section, "fz_n": force, "truth": truth, "thickness_m": "inf", "hardness_pa": "inf"}
    )
    values.update(zip(("p_max_pa", "area_m2", "approach_m"), figures))
    values.update(more)
    writer.writerow([f"{v:.7g}" if isinstance(v, float) else v for v in (values[c] for c in COLUMNS)])
    sys.stdout.flush()


def layers(radius, force, e1, nu1, h1, e2, nu2, h2):
    a, approach, peak = layered.paraboloid(radius, force, [(e1, nu1, h1), (e2, nu2, h2)])
    return peak, np.pi * a * a, approach


def layer(kind, low, high):
    """A round hull on a layer of ice with a thickness of `low` to `high` contact radii of the half-space."""
    radius, force = logarithmic(0.02, 2.0), logarithmic(100, 4000)
    patch = (0.75 * force * radius / modulus()) ** (1 / 3)
    thickness = patch * logarithmic(low, high)
    figures = layers(radius, force, E, NU, thickness / 2, E, NU, thickness / 2)
    row(kind, radius, radius, force, figures, 2e-4, thickness_m=thickness)


def draws(kind, count):
    """`count` draws of a class, or the number from the command line."""
    return range(count if not CLASSES else int(sys.argv[2]) if kind in CLASSES else 0)


writer = csv.writer(sys.stdout, lineterminator="\n")
writer.writerow(COLUMNS)
for _ in draws("rigid Hertz", 70):
    section = logarithmic(1e-3, 2e-2)
    # The aspect ratio of the patch is about the ratio of the radii to the power 2/3.
    rocker, force = section * logarithmic(1.0, 3e4), logarithmic(100, 8000)
    row("rigid Hertz", rocker, section, force, hertz(rocker, section, modulus(), force))
for _ in draws("two elastic bodies", 20):
    section = logarithmic(2e-3, 2e-2)
    rocker, force = section * logarithmic(1.0, 2e4), logarithmic(100, 8000)
    row("two elastic bodies", rocker, section, force, hertz(rocker, section, modulus(True), force), steel=1)
for _ in draws("offset load", 25):
    section, rocker, force = logarithmic(3e-3, 1e-2), logarithmic(5, 60), logarithmic(100, 4000)
    places = {"offset_x_m": random.uniform(-0.02, 0.02) * rocker, "offset_y_m": random.uniform(-0.1, 0.1) * section}
    row("offset load", rocker, section, force, hertz(rocker, section, modulus(), force), **places)
for kind, count, low, high in (("thick layer", 15, 1.0, 10.0), ("layer as thick as the patch", 15, 0.1, 1.0), ("thin layer", 15, 0.02, 0.1)):
    for _ in draws(kind, count):
        layer(kind, low, high)
for _ in draws("elastic bed", 15):
    radius, force = logarithmic(0.02, 2.0), logarithmic(100, 4000)
    patch = (0.75 * force * radius / modulus()) ** (1 / 3)
    thickness, bed, bed_modulus = patch * logarithmic(0.3, 3), patch * logarithmic(1, 5), logarithmic(3e9, 60e9)
    figures = layers(radius, force, E, NU, thickness, bed_modulus, 0.2, bed)
    row("elastic bed", radius, radius, force, figures, 2e-4, thickness_m=thickness, bed_youngs_modulus_pa=bed_modulus, bed_thickness_m=bed)
for _ in draws("no paraboloid", 20):
    section, force = logarithmic(3e-3, 1e-2), logarithmic(100, 4000)
    rocker = section * logarithmic(1, 3e3)
    peak, area, _ = hertz(rocker, section, modulus(), force)
    ratio = (rocker / section) ** (2 / 3)
    a, b = np.sqrt(area / np.pi * ratio), np.sqrt(area / np.pi / ratio)
    quartic = logarithmic(0.05, 3) / (2 * rocker * a * a)
    gap = lambda x, y: x * x / (2 * rocker) + quartic * x**4 + y * y / (2 * section)
    *figures, truth = boundary(gap, force, np.inf, (1.25 * a, 1.5 * b))
    row("no paraboloid", rocker, section, force, figures, truth, quartic_1pm3=quartic)
for _ in draws("ice that yields", 15):
    section, force = logarithmic(3e-3, 1e-2), logarithmic(100, 4000)
    rocker = section * logarithmic(1, 3e3)
    peak, area, _ = hertz(rocker, section, modulus(), force)
    share = random.uniform(0.3, 0.95)
    ratio = (rocker / section) ** (2 / 3)
    area /= share
    a, b = np.sqrt(area / np.pi * ratio), np.sqrt(area / np.pi / ratio)
    gap = lambda x, y: x * x / (2 * rocker) + y * y / (2 * section)
    *figures, truth = boundary(gap, force, share * peak, (1.35 * a, 1.5 * b))
    row("ice that yields", rocker, section, force, figures, truth, hardness_pa=share * peak)
# Independent of the rows above, on which the error estimates were developed.
random = np.random.default_rng(SEED + 1)
for kind, low, high in (("layer as thick as the patch", 0.1, 1.0), ("thin layer", 0.02, 0.1)):
    for _ in draws(f"{kind} anew", 15):
        layer(f"{kind} anew", low, high)
# Pressure peaks along both rounded edges of the flat.
random = np.random.default_rng(SEED + 8)
for _ in draws("worn flat", 30):
    rocker, section, force = logarithmic(15, 60), logarithmic(3.5e-3, 8e-3), logarithmic(500, 5000)
    worn, edge = logarithmic(2e-6, 15e-6), logarithmic(1e-4, 5e-4)

    def gap(x, y):
        above = arc(section, y) - worn
        return arc(rocker, x) + 0.5 * (above + np.hypot(above, edge / section * worn))

    reach = reach_of(gap, force, (4e-3 * np.sqrt(rocker * force / 1000), 1.4 * np.sqrt(2 * section * worn)))
    peak, _, approach, truth = boundary(gap, force, np.inf, reach, (24, 512))
    # 48 rectangles along the contact do not resolve its length: no reference area.
    row("worn flat", rocker, section, force, (peak, 0, approach), truth, worn_m=worn, worn_edge_m=edge)
for line in [] if CLASSES else csv.DictReader((pathlib.Path(__file__).parent / "slender.csv").open()):
    numbers = {key: float(value) for key, value in line.items()}
    worn = numbers["worn_m"]
    kind = "narrow flat" if worn else "peaks at the ends"
    figures = (numbers["p_max_pa"], 0, 0)
    row(kind, numbers["rocker_radius_m"], numbers["section_radius_m"], numbers["fz_n"], figures, 2e-3, worn_m=worn, worn_edge_m=0.2 * numbers["section_radius_m"] if worn else 0, curvature_1pm=line["curvature_1pm"])
