"""Hertz contacts by ContactMechanics (free-space FFT), one process a measurement.

    contactmechanics_hertz.py one N    # N x N points in a window 1.2 times the patch
    contactmechanics_hertz.py hand N   # 64 contacts, each in a window of its own sized so

Prints the largest true error of p_max and the seconds of building and solving.
"""
import sys
import time

import numpy as np
from ContactMechanics import FreeFFTElasticHalfSpace
from ContactMechanics.Systems import NonSmoothContactSystem
from SurfaceTopography import Topography

from hertz import E_STAR, SECTION, hertz, points

ROOM = 1.2


def solve(rocker, force, window, n):
    x, y = ((np.arange(n) - n // 2) * length / n for length in window)
    surface = -(x[:, None] ** 2 / (2 * rocker) + y[None, :] ** 2 / (2 * SECTION))
    system = NonSmoothContactSystem(FreeFFTElasticHalfSpace((n, n), E_STAR, window), Topography(surface, window))
    found = system.minimize_proxy(external_force=force, pentol=1e-10)
    if not found.success:
        raise SystemExit(f"{rocker} m, {force} N: {found.message}")
    return found.jac.max() * n * n / np.prod(window)


def main():
    mode, n = sys.argv[1], int(sys.argv[2])
    worst, begun = 0.0, time.perf_counter()
    for rocker, force in [(30.0, 1000.0)] if mode == "one" else points():
        a, b, exact = hertz(rocker, force)
        worst = max(worst, abs(solve(rocker, force, (2 * ROOM * a, 2 * ROOM * b), n) / exact - 1))
    print(worst, time.perf_counter() - begun)


main()
