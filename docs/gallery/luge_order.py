#!/usr/bin/env python3
"""Which of the order of the seven luge steels of the ice house do groove and melt film explain?

    python3 docs/gallery/luge_order.py target/release/kufe

Their shapes are not published. Friction is computed on a grid of shapes (500 N, ice of -1.5 C, 2.4 m/s) and read off it for 20000 sets of seven runners, two ways:
edges and tilts that go with the words that describe the steels, in their order; and round sections whose elastic peak pressure is the one published, within its
standard deviation. The rank correlation of each set with the measured coefficients is counted. Nothing is fitted.
"""

import itertools
import json
import math
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

# specimen, rocker, section, setting, peak pressure and its standard deviation [MPa], mu and its own [1e-3] (arXiv 2109.07252)
STEELS = [
    ("Alpha 1", "high", "round", "wide", 7.7, 0.4, 4.5, 0.4),
    ("Alpha 2", "low", "round", "wide", 8.6, 0.5, 3.8, 0.4),
    ("Beta 1", "high", "sharp", "narrow", 13.6, 0.7, 4.2, 0.4),
    ("Beta 2", "low", "sharp", "narrow", 16.0, 0.9, 4.6, 0.4),
    ("Gamma 1", "high", "normal", "narrow", 10.9, 0.6, 3.0, 0.3),
    ("Gamma 2", "low", "normal", "narrow", 11.8, 0.6, 2.7, 0.3),
    ("Gamma 3", "high", "normal", "wide", 9.6, 0.5, 3.3, 0.3),
]
MEASURED = [steel[6] for steel in STEELS]
BLUNT = [k for k, steel in enumerate(STEELS) if steel[2] != "sharp"]
ROCKERS, EDGES, TILTS = [10.0, 20.0, 40.0], [0.2e-3, 0.6e-3, 2e-3, 6e-3], [0.005, 0.02, 0.06]
SECTIONS = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2]
EDGE = 'kind = "luge", length_m = 0.6, width_m = 0.020, height_m = 0.030, rocker_radius_m = {}, edge_radius_m = {}, tilt_rad = {}'
ROUND = 'kind = "paraboloid", rocker_radius_m = {}, section_radius_m = {}'
CASE = """[runner]
shape = {{ {} }}
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = "half-space"
[load]
fz_n = 500.0
tilt = "fixed"
[accuracy]
p_max = 0.06
"""


def result_of(kufe, *words):
    return json.loads(subprocess.run([kufe, *map(str, words), "--json"], check=True, capture_output=True).stdout)


def computed(kufe, shape, places, pressure):
    """mu [1e-3] at every place and, where asked for, the elastic peak pressure [MPa]."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.toml" for k in range(len(places))]
        for file, place in zip(files, places):
            file.write_text(CASE.format(shape.format(*place)))
        points = result_of(kufe, "friction", *files, "--groove", "--v-mps", 2.4, "--ice-c", -1.5)["points"]
        mu = {place: 1e3 * point["mu"] for place, point in zip(places, points)}
        solve = lambda file: 1e-6 * result_of(kufe, "press", file, "-o", Path(folder) / "out")["p_max_pa"]
        return mu, {place: solve(file) for place, file in zip(places, files)} if pressure else {}


def between(table, axes, place):
    """The value there, its logarithm linear in those of the shape's numbers."""
    sides = []
    for nodes, value in zip(axes, place):
        k = min(max(sum(node <= value for node in nodes), 1), len(nodes) - 1)
        share = math.log(value / nodes[k - 1]) / math.log(nodes[k] / nodes[k - 1])
        sides.append([(nodes[k - 1], 1 - share), (nodes[k], share)])
    corners = itertools.product(*sides)
    return math.exp(sum(math.prod(w for _, w in c) * math.log(table[tuple(n for n, _ in c)]) for c in corners))


def with_pressure(table, rocker, pressure):
    """The section radius of that peak pressure, by bisection: blunter ones press less."""
    low, high = SECTIONS[0], SECTIONS[-1]
    for _ in range(30):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if between(table, (ROCKERS, SECTIONS), (rocker, middle)) > pressure else (low, middle)
    return low


def spearman(a, b):
    rank = lambda values: [sum(v < value for v in values) + (sum(v == value for v in values) - 1) / 2 for value in values]
    return statistics.correlation(rank(a), rank(b))


def report(title, sets):
    print(title)
    for name, which in (("all seven", range(len(STEELS))), ("without the two sharp ones", BLUNT)):
        found = sorted(spearman([mu[k] for k in which], [MEASURED[k] for k in which]) for mu in sets)
        at = [found[round(share * (len(found) - 1))] for share in (0.05, 0.5, 0.95)]
        print(f"  {name}: rank correlation {at[1]:.2f} ({at[0]:.2f} to {at[2]:.2f}), largest {found[-1]:.2f}")
    for k, steel in enumerate(STEELS):
        mu = sorted(mu[k] for mu in sets)
        low, high = mu[len(mu) // 20], mu[-len(mu) // 20]
        print(f"  {steel[0]}: measured {steel[6]} +- {steel[7]}, computed {low:.1f} to {high:.1f}")


def main():
    kufe, chance = sys.argv[1], random.Random(1)
    ratio = lambda low, high: low * (high / low) ** chance.random()
    ordered = lambda words, low, high: dict(zip(words, sorted(ratio(low, high) for _ in words)))
    mu, _ = computed(kufe, EDGE, list(itertools.product(ROCKERS, EDGES, TILTS)), False)
    sets = []
    for _ in range(20000):
        rocker, edge = ordered(("low", "high"), 10, 40), ordered(("sharp", "normal", "round"), 0.2e-3, 6e-3)
        tilt = ordered(("wide", "narrow"), 0.005, 0.06)
        sets.append([between(mu, (ROCKERS, EDGES, TILTS), (rocker[r], edge[e], tilt[t])) for _, r, e, t, *_ in STEELS])
    report("edges of 0.2 to 6 mm, tilts of 5 to 60 mrad, rockers of 10 to 40 m:", sets)
    mu, peaks = computed(kufe, ROUND, list(itertools.product(ROCKERS, SECTIONS)), True)
    sets = []
    for _ in range(20000):
        rocker = ordered(("low", "high"), 10, 40)
        shapes = [(rocker[steel[1]], chance.gauss(steel[4], steel[5])) for steel in STEELS]
        sets.append([between(mu, (ROCKERS, SECTIONS), (r, with_pressure(peaks, r, p))) for r, p in shapes])
    report("round sections with the published peak pressures, rockers of 10 to 40 m:", sets)


main()
