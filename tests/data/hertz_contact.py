"""Hertz' closed form."""
import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk


def ellipse(rocker, section, contact_modulus, force):
    """Longer and shorter half-axis and the parameter m = e^2 = 1 - b^2/a^2 of the patch: K. L. Johnson, Contact Mechanics (1985), section 4.2."""
    long, short = max(rocker, section), min(rocker, section)

    def ratio(m):
        """A/B = R_short / R_long of an ellipse of parameter m = e^2."""
        k, e = ellipk(m), ellipe(m)
        return (k - e) * (1 - m) / (e - (1 - m) * k)

    m = 0.0 if long / short < 1 + 1e-9 else brentq(lambda m: ratio(m) - short / long, 1e-12, 1 - 1e-13, xtol=1e-16, rtol=1e-14)
    k = np.sqrt(1 - m)
    total = 0.5 * (1 / rocker + 1 / section)
    a = (3 * force * ellipe(m) / (2 * np.pi * contact_modulus * total * (1 - m))) ** (1 / 3)
    return a, k * a, m


def hertz(rocker, section, contact_modulus, force):
    """Peak, area, approach."""
    a, b, m = ellipse(rocker, section, contact_modulus, force)
    peak = 1.5 * force / (np.pi * a * b)
    return peak, np.pi * a * b, peak * b * ellipk(m) / contact_modulus
