"""kufe and the programs people would use instead, in one run: whole process, work alone, true error, ratio.

    python benches/peers/compare.py target/release/fields [--slow]

GetFEM, which has no window but a mesh, is run by the interpreter that GETFEM_PYTHON names, once: it takes minutes.
`--slow` measures instead what a peer's user who sizes no windows gets: 64 contacts in the window of the largest.
Every figure is the fastest of three processes. A peer gets the coarsest of its grids from which on every finer one
is at least as good as requested, in a window sized by Hertz' formulas: its user has to know the patch already.
"""
import math
import os
import subprocess
import sys
import time
from pathlib import Path

from hertz import hertz, points

HERE = Path(__file__).parent
ROUNDS = 3
GRIDS = [16, 24, 32, 48]
# Over half the patch, each way.
GETFEM_CELLS = 4
ALONE = "kufe, boundary elements alone, 32 x 32, no window given"


def measured(command, rounds=ROUNDS):
    """Whole seconds and the numbers printed, of the fastest of several processes."""
    best = None
    for _ in range(rounds):
        begun = time.perf_counter()
        output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        whole = time.perf_counter() - begun
        if best is None or whole < best[0]:
            best = (whole, [float(word) for word in output.split()])
    return best


def script(name, *arguments):
    return [sys.executable, str(HERE / name), *map(str, arguments)]


def coarsest(name, mode, requested):
    """The peer's grid: the coarsest with every finer one within `requested`."""
    chosen = None
    for n in reversed(GRIDS):
        if measured(script(name, mode, n), 1)[1][0] > requested:
            break
        chosen = n
    return chosen


def row(label, error, whole, work, base):
    ratio = "1" if base is None else f"{whole / base[0]:.2f} / {work / base[1]:.2f}"
    print(f"| {label} | {100 * error:.3f} % | {whole:.3f} s | {work:.3f} s | {ratio} |", flush=True)


def table(title, requested, mine, others, mode):
    print(f"\n### {title}, requested error {100 * requested:g} %\n")
    print("| program | true error | whole process | work alone | times kufe's: process / work |")
    print("|---|---|---|---|---|")
    whole, numbers = mine
    base = (whole, numbers[1])
    row("kufe", numbers[-1] if mode == "one" else numbers[0], whole, numbers[1], None)
    for label, (whole, (error, work)) in others.items():
        row(label, error, whole, work, base)
    for label, name in [("Tamaas", "tamaas_hertz.py"), ("ContactMechanics", "contactmechanics_hertz.py")]:
        n = coarsest(name, mode, requested)
        if n is None:
            print(f"| {label} | over the requested error up to {GRIDS[-1]} x {GRIDS[-1]} points | | | |")
            continue
        whole, (error, work) = measured(script(name, mode, n))
        row(f"{label}, {n} x {n}, window sized by hand", error, whole, work, base)


def getfem(base):
    """A row for GetFEM at the accuracy that its mesh gives, where its interpreter is named."""
    python = os.environ.get("GETFEM_PYTHON")
    if not python:
        print("\nGetFEM is not installed.")
        return
    whole, (error, work, unknowns) = measured([python, str(HERE / "getfem_hertz.py"), str(GETFEM_CELLS)], 1)
    row(f"GetFEM, {unknowns:.0f} unknowns, mesh sized by hand", error, whole, work, base)


def one_window(fields, requested):
    """64 contacts by Tamaas in the window of the largest, fine enough for 16 points across the smallest."""
    sized = [hertz(*case) for case in points()]
    shape = [math.ceil(16 * 1.2 * max(s[axis] for s in sized) / min(s[axis] for s in sized)) for axis in (0, 1)]
    whole, (worst, seconds) = measured([fields, "all", str(requested)])
    base = (whole, seconds)
    print(f"\n### 64 contacts in one window, requested error {100 * requested:g} %\n")
    print("| program | true error | whole process | work alone | times kufe's: process / work |")
    print("|---|---|---|---|---|")
    row("kufe, no window", worst, whole, seconds, None)
    whole, (error, work) = measured(script("tamaas_hertz.py", "window", *shape), 1)
    row(f"Tamaas, one window of {shape[0]} x {shape[1]}", error, whole, work, base)


def main():
    fields = sys.argv[1]
    if "--slow" in sys.argv[2:]:
        return one_window(fields, 0.005)
    os.environ.setdefault("OMP_NUM_THREADS", str(os.cpu_count()))
    mine = measured([fields, "one", "0.005"])
    others = {ALONE: measured([fields, "plane", "one"])}
    table("One contact: rocker 30 m, section 5 mm, 1 kN", 0.005, mine, others, "one")
    getfem((mine[0], mine[1][1]))
    others = {
        "kufe, finite elements throughout": measured([fields, "all", "0.005"]),
        ALONE: measured([fields, "plane", "all"]),
    }
    table("64 contacts: 8 loads by 8 radii", 0.005, measured([fields, "anchored", "0.005"]), others, "hand")


main()
