"""The two-body problem of a luge steel on its bridges in CalculiX (Debian package calculix-ccx): the same force, approach and pressures?

    python3 benches/peers/calculix.py target/release/kufe [FOLDER]

`kufe export CASE --calculix DECK` writes the deck: kufe's own mesh, pressed down by the approach that kufe found on it, contact by
CalculiX's mortar method. Both programs' pressures are compared as means over the faces of the underside. The force that
CalculiX finds at that approach is not quite kufe's, whose runner has another element; kufe solves again under it, and what
kufe's peak and approach change by brings CalculiX's to the case's load. Three meshes give each program's limit and its error:
what the finest is off by, of second order in the cells. Exit code 1 where the two differ by more than the errors' sum, or 3 %.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np

FORCE = 400.0
CASE = """[runner]
shape = {{ kind = "luge", length_m = 0.2, rocker_radius_m = 6.0, edge_radius_m = 2e-3, tilt_rad = 0.05, width_m = 0.012, height_m = 0.008 }}
elastic = true
mount = {{ held = [{{ x_m = -0.06, length_m = 0.012 }}, {{ x_m = 0.06, length_m = 0.012 }}] }}
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.01
[load]
fz_n = {force!r}
tilt = "fixed"
"""
CELLS = [int(word) for word in os.environ.get("CALCULIX_CELLS", "2,3,4").split(",")]
MOST = 0.03


def timed(command, folder):
    """CPU time of a command, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def export(kufe, folder, cells, force, name):
    """Writes a deck; CPU time and kufe's figures."""
    with open(os.path.join(folder, "case.toml"), "w") as file:
        file.write(CASE.format(force=force))
    cpu, output = timed([kufe, "export", "case.toml", "--calculix", f"{name}.inp", "--cells", str(cells), "--json"], folder)
    return cpu, json.loads(output)


class Deck:
    """The underside's nodes on their grid (y by x) and kufe's pressures there in MPa."""

    def __init__(self, path):
        nodes, bottoms, faces, own, section = {}, {}, [], {}, ""
        for line in open(path):
            words = line.replace(",", " ").split()
            if line.startswith("**"):
                if len(words) == 3 and words[1].isdigit():
                    own[int(words[1])] = float(words[2])
            elif line.startswith("*"):
                section = line.strip()
            elif section.startswith("*NODE, NSET"):
                nodes[int(words[0])] = [float(word) for word in words[1:]]
            elif section.startswith("*ELEMENT") and section.endswith("ELSET=RUNNER"):
                bottoms[int(words[0])] = [int(word) for word in words[1:5]]
            elif section.startswith("*SURFACE, NAME=UNDERSIDE"):
                faces.append(bottoms[int(words[0])])
        self.places = {node: nodes[node][:2] for node in set(np.ravel(faces))}
        self.x, self.y = (np.unique([place[axis] for place in self.places.values()]) for axis in [0, 1])
        self.areas = np.outer(np.diff(self.y), np.diff(self.x))
        self.own = self.on_grid(own)

    def on_grid(self, by_node):
        grid = np.zeros((len(self.y), len(self.x)))
        for node, (x, y) in self.places.items():
            grid[np.searchsorted(self.y, y), np.searchsorted(self.x, x)] = by_node.get(node, 0.0)
        return grid

    def borne(self, grid):
        """Force of nodal pressures that are means weighted with the nodes' hat functions [N]."""
        lumped = [np.convolve(np.diff(nodes), [0.5, 0.5]) for nodes in [self.y, self.x]]
        return lumped[0] @ grid @ lumped[1]

    def pressures(self, means, mirror):
        """Pressures from such means: inside the contact the share of the hats' moments is taken out, as kufe does with its own."""
        corrected = means.copy()
        for j, line in enumerate(means):
            corrected[j] -= share(self.x, line, mirror[0])
        for i, line in enumerate(means.T):
            corrected[:, i] -= share(self.y, line, mirror[1])
        return np.where(means > 0, np.maximum(corrected, 0), 0)


def faces(grid):
    """Means over the faces between nodes."""
    return (grid[1:, 1:] + grid[1:, :-1] + grid[:-1, 1:] + grid[:-1, :-1]) / 4


def share(nodes, line, mirror):
    """m1 p' + m2 p'' / 2 of the hat functions with moments m1, m2, on a line of nodes; 0 next to nodes without pressure."""
    if mirror:
        nodes, line = np.concatenate([[-nodes[1]], nodes]), np.concatenate([[line[1]], line])
    out = np.zeros(len(line))
    h0, h1 = np.diff(nodes)[:-1], np.diff(nodes)[1:]
    down, up = np.diff(line)[:-1] / h0, np.diff(line)[1:] / h1
    slope, curvature = (down * h1 + up * h0) / (h0 + h1), 2 * (up - down) / (h0 + h1)
    inside = (line[:-2] > 0) & (line[1:-1] > 0) & (line[2:] > 0)
    value = (h1 - h0) / 3 * slope + (h0**3 + h1**3) / (6 * (h0 + h1)) * curvature / 2
    out[1:-1] = np.where(inside, value, 0)
    return out[1:] if mirror else out


def forces(path):
    """Total vertical force on the node sets that the deck prints, by name [N]."""
    found, name = {}, None
    for line in open(path):
        if line.strip().startswith("total force"):
            name = line.split("for set")[1].split()[0]
        elif name and line.split():
            found[name] = float(line.split()[2])
            name = None
    return found


def pressures(path):
    """Contact pressure at the nodes of the last CONTACT block of a result file in MPa."""
    values, inside = {}, False
    for line in open(path):
        if line.startswith(" -4"):
            inside = line.split()[1] == "CONTACT"
            if inside:
                values, columns = {}, []
        elif inside and line.startswith(" -5"):
            columns.append(line.split()[1])
        elif inside and line.startswith(" -1"):
            numbers = [float(line[13 + 12 * k : 25 + 12 * k]) for k in range(len(columns))]
            values[int(line[3:13])] = numbers[columns.index("CPRESS")]
        elif inside and line.startswith(" -3"):
            inside = False
    return values


def level(kufe, folder, cells):
    """Both programs on one mesh."""
    own_cpu, own = export(kufe, folder, cells, FORCE, f"deck{cells}")
    ccx_cpu, _ = timed(["ccx", f"deck{cells}"], folder)
    path = lambda end: os.path.join(folder, f"deck{cells}.{end}")
    copies = 2 ** sum(own["symmetry"])
    total = forces(path("dat"))
    force = -copies * total["MOUNT"]
    deck = Deck(path("inp"))
    multipliers = deck.on_grid(pressures(path("frd")))
    # The multipliers are weighted means where they bear the mount's force.
    borne = copies * deck.borne(multipliers)
    if abs(borne / force - 1) > 0.01:
        sys.exit(f"{cells} cells: CalculiX's pressures bear {borne:.1f} N, its mount {force:.1f} N")
    ours, theirs = faces(deck.own), faces(deck.pressures(multipliers, own["symmetry"]))
    _, again = export(kufe, folder, cells, force, "again")
    same = Deck(os.path.join(folder, "again.inp"))
    brought = {
        "peak": theirs.max() * ours.max() / faces(same.own).max(),
        "approach": own["approach_m"] ** 2 / again["approach_m"],
    }
    weighed = lambda values: np.sqrt(np.sum(values**2 * deck.areas))
    return {
        "cells": cells,
        "dofs": own["dofs"],
        "force": force,
        "imbalance": abs(total["MOUNT"] + total["BED"]) / abs(total["BED"]),
        "kufe": {"peak": ours.max(), "approach": own["approach_m"]},
        "CalculiX": brought,
        "maps": weighed(theirs * FORCE / force - ours) / weighed(ours),
        "cpu": (own_cpu, ccx_cpu),
    }


def limit(cells, values):
    """The limit of a quantity and the remaining error on the finest mesh: least squares of v + c / cells^2."""
    design = np.array([[1.0, 1 / n**2] for n in cells])
    (found, slope), *_ = np.linalg.lstsq(design, np.array(values), rcond=None)
    return found, abs(values[-1] - found) + np.abs(design @ [found, slope] - values).max()


def main():
    kufe = os.path.abspath(sys.argv[1])
    folder = sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp()
    print("| cells over half the patch | unknowns | force at one approach: kufe, CalculiX | peak at 400 N | approach at 400 N | maps apart (L2) | CPU |")
    print("|---|---|---|---|---|---|---|", flush=True)
    levels = []
    for cells in CELLS:
        levels.append(level(kufe, folder, cells))
        at = levels[-1]
        pair = lambda name, scale: ", ".join(f"{scale * at[program][name]:.2f}" for program in ["kufe", "CalculiX"])
        print(
            f"| {cells} | {at['dofs']} | {FORCE:.1f}, {at['force']:.1f} N | {pair('peak', 1)} MPa | {pair('approach', 1e6)} µm "
            f"| {100 * at['maps']:.1f} % | {at['cpu'][0]:.1f}, {at['cpu'][1]:.1f} s |",
            flush=True,
        )
    good = True
    print()
    for name, scale, unit in [("peak", 1, "MPa"), ("approach", 1e6, "µm")]:
        found = {program: limit(CELLS, [scale * at[program][name] for at in levels]) for program in ["kufe", "CalculiX"]}
        (ours, our_error), (theirs, their_error) = found["kufe"], found["CalculiX"]
        finest = [scale * levels[-1][program][name] for program in ["kufe", "CalculiX"]]
        apart, errors = abs(finest[1] - finest[0]), our_error + their_error
        print(
            f"{name}: {finest[0]:.2f} (kufe, error {our_error:.2f}) and {finest[1]:.2f} {unit} (CalculiX, error {their_error:.2f}): "
            f"{100 * apart / finest[0]:.2f} % apart, errors {100 * errors / finest[0]:.2f} %; limits {ours:.2f} and {theirs:.2f} {unit}, "
            f"{100 * abs(theirs / ours - 1):.2f} % apart"
        )
        good &= apart <= max(errors, 1e-3 * finest[0]) and abs(theirs / ours - 1) <= MOST
    print(f"mount and bed in CalculiX: {max(at['imbalance'] for at in levels):.1e} apart")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
