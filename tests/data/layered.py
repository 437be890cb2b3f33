"""A rigid or layered elastic paraboloid on bonded elastic layers over a rigid bed, by Hankel transforms.

    python layered.py RADIUS FORCE E1 NU1 H1 E2 NU2 H2

Prints contact radius, approach and peak pressure. The pressure is a sum of (1 - r^2/a^2)^(m + 1/2), whose Hankel
transforms are Bessel functions; the surface compliance of the layers comes from the equations of elasticity in depth,
for each wave number (I. N. Sneddon, Fourier Transforms, 1951, ch. 10).
"""
import sys

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import gamma, j0, jv


def lame(e, nu):
    return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))


def compliance(k, layers):
    """Downward displacement of the surface under a unit pressure of wave number k."""
    top_lambda, top_mu = lame(*layers[0][:2])
    if k * layers[0][2] > 20:
        return (1 - layers[0][1]) / (top_mu * k)
    c = np.zeros((2, 2))  # displacement = c . traction, from the rigid bed upwards
    for e, nu, height in reversed(layers):
        l, m = lame(e, nu)
        s = l + 2 * m
        # d/dz (U, W, tau, sigma) for u_r = U J1(kr), u_z = W J0(kr)
        a = np.array([
            [0, k, 1 / m, 0],
            [-l * k / s, 0, 0, 1 / s],
            [k * k * (s - l * l / s), 0, 0, l * k / s],
            [0, 0, -k, 0],
        ])
        steps = max(1, int(np.ceil(k * height / 2)))
        p = expm(a * (height / steps))
        for _ in range(steps):
            c = (p[:2, :2] @ c + p[:2, 2:]) @ np.linalg.inv(p[2:, :2] @ c + p[2:, 2:])
    return c[1, 1]


def paraboloid(radius, force, *bodies):
    """Contact radius, approach and peak; a body is a list of layers (E, nu, thickness) from the contact to its rigid support."""
    guess = (0.75 * force * radius * sum((1 - nu**2) / e for (e, nu, _), *_ in bodies)) ** (1 / 3)
    # Piecewise Gauss-Legendre rule, which resolves wave numbers of 1/h (layers) and 1/a (contact).
    points, weights = np.polynomial.legendre.leggauss(8)
    edges = np.concatenate([np.linspace(0, 4, 60)[:-1], np.geomspace(4, 4000, 1500)]) / (2 * guess)
    low, high = edges[:-1, None], edges[1:, None]
    k = (0.5 * (high + low) + 0.5 * (high - low) * points).ravel()
    w = (0.5 * (high - low) * weights).ravel()
    # The ratio to the compliance of the half-space is a smooth function of log k.
    own = sum((1 - nu) / lame(e, nu)[1] for (e, nu, _), *_ in bodies)
    nodes = np.linspace(np.log(k[0]), np.log(k[-1]), 240)
    both = [sum(compliance(np.exp(n), layers) for layers in bodies) for n in nodes]
    ratio = CubicSpline(nodes, both * np.exp(nodes) / own)
    table = ratio(np.log(k)) * own / k
    # With six terms the error is 0.01 % of the peak and 0.1 % of the radius on a layer a tenth of the patch thick; twelve differ by at most 5e-5.
    powers = np.arange(10) + 0.5

    def solved(a):
        r = a * np.linspace(0.0, 0.99, 100)
        ka = k * a
        waves = j0(np.outer(r, k))
        columns = []
        for mu in powers:
            transform = a * a * 2**mu * gamma(mu + 1) * jv(mu + 1, ka) / ka ** (mu + 1)
            columns.append(waves @ (table * k * transform * w))
        # sum of pressures' displacements - approach = - r^2 / 2R
        scale = columns[0][0]
        system = np.column_stack([c / scale for c in columns] + [-np.ones_like(r)])
        answer = np.linalg.lstsq(system, -(r**2) / (2 * radius), rcond=None)[0]
        pressures, approach = answer[:-1] / scale, answer[-1]
        return pressures, approach, np.pi * a * a * np.sum(pressures / (powers + 1))

    a = brentq(lambda a: solved(a)[2] - force, 0.3 * guess, 2.0 * guess, rtol=1e-8)
    pressures, approach, _ = solved(a)
    return a, approach, pressures.sum()


def main():
    radius, force, e1, nu1, h1, e2, nu2, h2 = map(float, sys.argv[1:])
    print(*paraboloid(radius, force, [(e1, nu1, h1), (e2, nu2, h2)]))


if __name__ == "__main__":
    main()
