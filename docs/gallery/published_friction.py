#!/usr/bin/env python3
"""What can published friction of steel on ice tell of boundary contact?

    python3 docs/gallery/published_friction.py target/release/kufe ice_friction.csv OUT

ice_friction.csv holds measured coefficients with `id, mu, mu_lo, mu_hi`; it is not part of kufe. Loads and shapes are not published: those below are assumed, one a
source. The section of a luge steel is round, with the published elastic peak pressure.

1. Groove, film and boundary contact of every point, with each of six stated pairs of shear stress and roughness, and without. For each source the pair is chosen
   that the other sources prefer, and compared with it. Nothing is tuned to a source.
2. `kufe discover` on OUT/experiments.csv: base law the film, mu less the computed ploughing. Once with all sources, once without each.
"""

import csv
import json
import math
import subprocess
import sys
from pathlib import Path

BOB = 'kind = "bob", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.004, width_m = 0.008, height_m = 0.030'
SKATE = 'kind = "bob", length_m = 0.40, rocker_radius_m = 23.0, section_radius_m = 0.5, width_m = 0.0011, height_m = 0.030'
ROUND = 'kind = "paraboloid", rocker_radius_m = 20.0, section_radius_m = {:.6g}'
# source: rows of the table, shape, load [N], speeds [m/s], ice [C]
SOURCES = {
    "bob, ice house": (["poirier2011-house"], BOB, 950.0, [1.0, 2.4, 5.0, 10.0], -5.0),
    "bob, track": (["poirier-track"], BOB, 950.0, [20.0, 30.0], -5.0),
    "speed skates": (["dekoning-straight", "dekoning-curve"], SKATE, 700.0, [8.0], -4.6),
}
STEELS = ["alpha1", "alpha2", "gamma1", "gamma2", "gamma3", "beta1", "beta2"]
STEEL_N, STEEL_MPS, STEEL_C = 500.0, 2.36, -1.5
SECTIONS = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2]
PAIRS = [(0.0, 0.0)] + [(shear, roughness) for shear in (60e3, 100e3) for roughness in (0.3e-6, 0.5e-6, 1.0e-6)]
# Skates have no stated deviation: half of what straights and curves differ by.
SKATE_SD = 0.65e-3
CASE = """[runner]
shape = {{ {shape} }}
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = "half-space"
[load]
fz_n = {load}
tilt = "fixed"
[accuracy]
p_max = 0.03
"""
SLIDING = """[sliding]
v_mps = {speed}
ice_c = {ice}
roughness_m = {roughness}
boundary_shear_pa = {shear}
"""
MODEL = """[sled]
mass_kg = 390.0
j_yy_kgm2 = 145.0
j_zz_kgm2 = 150.0
l_f_m = 0.82
l_r_m = 0.88
cda_m2 = 0.0
[friction.longitudinal]
film = true
[friction.front]
mu_zeta = 2.577
c = 0.024
e = 0.99
k_n_per_rad = 10522.0
[friction.rear]
mu_zeta = 3.288
c = 0.076
e = 0.99
k_n_per_rad = 49776.0
"""


def answer(kufe, *words):
    run = subprocess.run([kufe, *map(str, words), "--json"], capture_output=True, text=True)
    if run.returncode:
        sys.exit(f"kufe {' '.join(map(str, words))}: {run.stderr}")
    return json.loads(run.stdout)


def measured(path):
    """mu and its standard deviation by id; a range without a mean is uniform."""
    found = {}
    for row in csv.DictReader(open(path, newline="", encoding="utf-8")):
        number = lambda key: float(row[key]) if row[key] else math.nan
        mu, low, high = number("mu"), number("mu_lo"), number("mu_hi")
        sd = (high - low) / 2 if mu == mu else (high - low) / math.sqrt(12)
        found[row["id"]] = (mu if mu == mu else (low + high) / 2, sd if sd == sd else SKATE_SD, row["pressure_MPa"])
    return found


def section_of(kufe, folder, pressure):
    """The section radius [m] whose elastic peak is the pressure [MPa]: linear in logarithms between solved sections."""
    solved = []
    for section in SECTIONS:
        file = folder / f"elastic {section}.toml"
        file.write_text(CASE.format(shape=ROUND.format(section), load=STEEL_N))
        solved.append((1e-6 * answer(kufe, "press", file, "-o", folder / f"elastic {section}", "--force")["p_max_pa"], section))
    def at(pressure):
        for (high, a), (low, b) in zip(solved, solved[1:]):
            if pressure >= low or b == SECTIONS[-1]:
                return a * (b / a) ** (math.log(pressure / high) / math.log(low / high))
    return [at(p) for p in pressure]


def main():
    kufe, table, out = sys.argv[1], measured(sys.argv[2]), Path(sys.argv[3])
    out.mkdir(parents=True, exist_ok=True)
    points = []  # source, name, mu, sd, shape, load, speed, ice
    for source, (ids, shape, load, speeds, ice) in SOURCES.items():
        points += [(source, i, *table[i][:2], shape, load, v, ice) for i in ids for v in speeds]
    steels = ["schleinitz-" + name for name in STEELS]
    peaks = [float(table[i][2].split()[0]) for i in steels]
    for i, section in zip(steels, section_of(kufe, out, peaks)):
        source = "sharp luge steels" if "beta" in i else "luge steels"
        points.append((source, i, *table[i][:2], ROUND.format(section), STEEL_N, STEEL_MPS, STEEL_C))

    mu, rows = {}, []
    for place, (source, name, value, sd, shape, load, speed, ice) in enumerate(points):
        same = [k for k in range(place) if points[k][4:] == points[place][4:]]
        case = CASE.format(shape=shape, load=load)
        files = [out / f"{place} {k}.toml" for k in range(len(PAIRS))]
        for file, (shear, roughness) in zip(files, PAIRS):
            file.write_text(case + SLIDING.format(speed=speed, ice=ice, shear=shear, roughness=roughness))
        if same:
            mu[place], contact = mu[same[0]], rows[same[0]][-1]
        else:
            solved = answer(kufe, "friction", *files, "--groove", "--v-mps", speed, "--ice-c", ice)["points"]
            mu[place] = [point["mu"] for point in solved]
            contact = answer(kufe, "press", files[0], "-o", out / f"{place}", "--force")
        rows.append((source, name, value, sd, load, speed, ice, contact))

    sources = list(dict.fromkeys(point[0] for point in points))
    own = {s: [k for k, point in enumerate(points) if point[0] == s] for s in sources}
    misfit = lambda s, pair: sum(((points[k][2] - mu[k][pair]) / points[k][3]) ** 2 for k in own[s]) / len(own[s])
    print("mu in 1e-3. chosen: by the other sources.")
    print("source, speed: measured; film alone; 60 kPa, 0.5 um; chosen")
    for s in sources:
        pair = min(range(len(PAIRS)), key=lambda pair: sum(misfit(other, pair) for other in sources if other != s))
        shear, roughness = PAIRS[pair]
        for k in own[s]:
            of = [1e3 * mu[k][p] for p in (0, PAIRS.index((60e3, 0.5e-6)), pair)]
            print(f"{points[k][1]}, {points[k][6]:g} m/s: {1e3 * points[k][2]:.2f} +- {1e3 * points[k][3]:.2f}; " + "; ".join(f"{x:.2f}" for x in of))
        kept = [misfit(s, p) for p in (0, PAIRS.index((60e3, 0.5e-6)), pair)]
        print(f"  {s}: mean square misfit {kept[0]:.2f}; {kept[1]:.2f}; {kept[2]:.2f} with {shear / 1e3:g} kPa, {1e6 * roughness:g} um")

    (out / "model.toml").write_text(MODEL)
    for roughness in (0.3e-6, 0.5e-6, 1.0e-6):
        discover(kufe, out, rows, roughness, "all sources")
    for source in sources:
        discover(kufe, out, [row for row in rows if row[0] != source], 0.5e-6, f"without {source}")


def discover(kufe, out, rows, roughness, title):
    """A search with the film as base law and one roughness for all; mu is less the computed ploughing."""
    header = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,fz_n,v_mps,ice_c,contact_length_m,contact_width_m,roughness_m"
    lines = [header]
    for source, _, value, sd, load, speed, ice, contact in rows:
        less = value - contact["mu_ploughing"]
        width = contact["area_m2"] / contact["length_m"]
        lines.append(f"{source.replace(',', '')},{contact['p_max_pa']:.0f},0,{less:.6f},{sd:.6f},{load},{speed},{ice},{contact['length_m']:.5f},{width:.4g},{roughness}")
    (out / "experiments.csv").write_text("\n".join(lines) + "\n")
    report = answer(kufe, "discover", out / "experiments.csv", "--model", out / "model.toml", "-o", out / "found", "--force")
    base = ", ".join(f"{p['name']} {p['value']:.2f} ({p['low']:.2f} to {p['high']:.2f})" for p in report.get("base", []))
    steps = "; ".join(f"{s['class']} " + ", ".join(f"{p['name']} {p['value']:.3g} ({p['low']:.3g} to {p['high']:.3g})" for p in s["parameters"]) for s in report["steps"])
    least = [d["size"] for d in report["minimum_detectable"] if d["effect"] == "boundary"]
    print(f"{title}, {1e6 * roughness:g} um: {report['verdict']}; {base}; {steps}; smallest detectable boundary stress {least[0] / 1e3:.0f} kPa")


main()
