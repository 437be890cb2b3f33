"""Hertz contacts by Tamaas (`dcfft`), one process a measurement.

    tamaas_hertz.py one N              # N x N points, window 1.2 times the patch, which Hertz' formulas tell
    tamaas_hertz.py hand N             # 64 contacts, each in a window of its own sized so
    tamaas_hertz.py window NX NY       # 64 contacts in the window of the largest

Prints the largest true error of p_max and the seconds of building and solving.
"""
import sys
import time

import numpy as np
import tamaas as tm

from hertz import E, NU, SECTION, hertz, points

TOLERANCE = 1e-8
ROOM = 1.2


def solve(rocker, force, window, shape):
    x, y = ((np.arange(n) - n // 2) * length / n for length, n in zip(window, shape))
    surface = -np.ascontiguousarray(x[:, None] ** 2 / (2 * rocker) + y[None, :] ** 2 / (2 * SECTION))
    model = tm.Model(tm.model_type.basic_2d, list(window), list(shape))
    model.E, model.nu = E, NU
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tm.PolonskyKeerRey(model, surface, TOLERANCE)
    solver.setIntegralOperator("dcfft")
    solver.solve(force / np.prod(window))
    return model.traction.max()


def main():
    tm.set_log_level(tm.LogLevel.error)
    mode, *numbers = sys.argv[1:]
    shape = [int(n) for n in numbers] * (1 if mode == "window" else 2)
    cases = [(30.0, 1000.0)] if mode == "one" else points()
    sized = [hertz(*case) for case in cases]
    widest = [2 * ROOM * max(s[axis] for s in sized) for axis in (0, 1)]
    worst = 0.0
    begun = time.perf_counter()
    for (rocker, force), (a, b, exact) in zip(cases, sized):
        window = widest if mode == "window" else [2 * ROOM * a, 2 * ROOM * b]
        worst = max(worst, abs(solve(rocker, force, window, shape) / exact - 1))
    print(worst, time.perf_counter() - begun)


main()
