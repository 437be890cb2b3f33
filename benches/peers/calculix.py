"""The two-body problem of a luge steel on its bridges in CalculiX (Debian package calculix-ccx): the same peak and the same force?

    python3 benches/peers/calculix.py target/release/kufe [FOLDER]

`kufe export --calculix` writes the deck: its own mesh, pressed down by the approach that kufe found on it, contact by
CalculiX's surface-to-surface penalty. Two meshes give an error estimate for each program: what the finer changes, over
what a second-order method leaves.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile

CASE = """[runner]
shape = { kind = "luge", length_m = 0.2, rocker_radius_m = 6.0, edge_radius_m = 2e-3, tilt_rad = 0.05, width_m = 0.012, height_m = 0.008 }
elastic = true
mount = { held = [{ x_m = -0.06, length_m = 0.012 }, { x_m = 0.06, length_m = 0.012 }] }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.01
[load]
fz_n = 400.0
tilt = "fixed"
"""
CELLS = [int(word) for word in os.environ.get("CALCULIX_CELLS", "2,3").split(",")]


def timed(command, folder):
    """CPU and wall time of a command, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


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
    """Contact pressure at the nodes of the last CONTACT block of a result file in MPa [Pa]."""
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
            values[int(line[3:13])] = 1e6 * numbers[columns.index("CPRESS")]
        elif inside and line.startswith(" -3"):
            inside = False
    return values


def main():
    kufe = os.path.abspath(sys.argv[1])
    folder = sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp()
    with open(os.path.join(folder, "case.toml"), "w") as file:
        file.write(CASE)
    rows = []
    for cells in CELLS:
        name = f"deck{cells}"
        export = [kufe, "export", "--calculix", "case.toml", "--cells", str(cells), "-o", f"{name}.inp", "--json"]
        own_cpu, said = timed(export, folder)
        own = json.loads(said)
        ccx_cpu, _ = timed(["ccx", name], folder)
        copies = 2 ** sum(own["symmetry"])
        total = forces(os.path.join(folder, f"{name}.dat"))
        peak = max(pressures(os.path.join(folder, f"{name}.frd")).values())
        rows.append((cells, own, own_cpu, ccx_cpu, peak, -copies * total["MOUNT"], copies * total["BED"]))
    print("| cells over half the patch | unknowns | peak: kufe, CalculiX | force: kufe, CalculiX | CPU: kufe, CalculiX |")
    print("|---|---|---|---|---|")
    for cells, own, own_cpu, ccx_cpu, peak, force, _ in rows:
        print(
            f"| {cells} | {own['dofs']} | {own['p_max_pa'] / 1e6:.2f}, {peak / 1e6:.2f} MPa "
            f"| {own['fz_n']:.2f}, {force:.2f} N | {own_cpu:.1f}, {ccx_cpu:.1f} s |"
        )
    (n, a, *_), (m, b, *_) = rows[-2:]
    left = 1 / ((m / n) ** 2 - 1)
    own_error = left * abs(b["p_max_pa"] - a["p_max_pa"])
    ccx_error = left * abs(rows[-1][4] - rows[-2][4])
    # At one approach on one mesh the forces differ by the contact's penalty and the runner's element alone.
    apart = abs(rows[-1][4] - b["p_max_pa"])
    print(
        f"\nPeaks differ by {apart / 1e6:.2f} MPa; estimated errors {own_error / 1e6:.2f} (kufe) and {ccx_error / 1e6:.2f} MPa (CalculiX). "
        f"Forces differ by {100 * abs(rows[-1][5] / b['fz_n'] - 1):.2f} %; mount and bed in CalculiX by {100 * abs(rows[-1][5] / rows[-1][6] - 1):.1e} %."
    )
    sys.exit(0 if apart <= own_error + ccx_error else 1)


if __name__ == "__main__":
    main()
