"""What the comparisons have in common: the ice, the contacts, and Hertz' formulas for them."""
import math

E, NU, SECTION = 9.0e9, 0.33, 0.005
E_STAR = E / (1 - NU**2)


def points():
    """Eight loads from 250 to 4000 N by eight effective radii from 15 to 250 m, in geometric progressions."""
    spread = lambda low, high, i: low * (high / low) ** (i / 7)
    return [(spread(15.0, 250.0, i), spread(250.0, 4000.0, j)) for i in range(8) for j in range(8)]


def elliptic(m):
    """Complete integrals K(m) and E(m) by the arithmetic-geometric mean."""
    a, b, c, total, power = 1.0, math.sqrt(1 - m), math.sqrt(m), 0.0, 0.5
    for _ in range(12):  # the mean converges quadratically: 12 rounds do for any m below 1 - 1e-16
        total += power * c * c
        a, b, c, power = (a + b) / 2, math.sqrt(a * b), (a - b) / 2, 2 * power
    k = math.pi / (2 * a)
    return k, k * (1 - total)


def hertz(rocker, force, section=SECTION, modulus=E_STAR):
    """Half length a, half width b [m] and peak pressure [Pa] (K. L. Johnson, Contact Mechanics, section 4.2).

    rocker / section = (E / k'^2 - K) / (K - E), with k' = b / a; then (a b)^(3/2) follows from the load.
    """

    def ratio(kp):
        k, e = elliptic(1 - kp * kp)
        return (e / kp**2 - k) / (k - e)

    low, high = 1e-8, 1 - 1e-9
    for _ in range(200):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if ratio(middle) > rocker / section else (low, middle)
    kp = math.sqrt(low * high)
    k, e = elliptic(1 - kp * kp)
    m = 1 - kp * kp
    # 1 / (2 R1) = p0 b / (E* a^2 m) (K - E) and p0 = 3 F / (2 pi a b)
    a = (3 * force * rocker * (k - e) / (math.pi * modulus * m)) ** (1 / 3)
    b = kp * a
    return a, b, 3 * force / (2 * math.pi * a * b)


if __name__ == "__main__":
    print(*hertz(30.0, 1000.0))
