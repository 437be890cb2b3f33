"""Peak pressures of slender contacts on a half-space by boundary elements.

    python slender.py > slender.csv

Rectangles of uniform pressure on a graded grid, the displacement at their centres from A. E. H. Love's integral (1929),
with two mirror planes and an active set. At the transition from the rocker to the radius of the end the rectangles are a
quarter of the contact's half-width long; halving them changes the peaks by less than 0.1 %.
"""
import numpy as np

E, NU = 9e9, 0.33
CONTACT_MODULUS = E / (1 - NU**2)
LENGTH, WIDTH, HEIGHT, END_RADIUS, WORN_EDGE = 1.0, 0.010, 0.030, 0.1, 0.2


def arc(radius, x):
    return x * x / (radius + np.sqrt((radius - x) * (radius + x)))


class Runner:
    def __init__(self, rocker, section, worn):
        self.rocker, self.section, self.worn = rocker, section, worn
        rise = 0.5 * (HEIGHT - arc(section, WIDTH / 2) - arc(rocker, LENGTH / 2))
        rise = min(rise, 0.5 * END_RADIUS)
        self.corner = LENGTH / 2 - np.sqrt(rise * (2 * END_RADIUS - rise))

    def height(self, x, y):
        inner = np.minimum(x, self.corner)
        first = self.corner / self.rocker
        last = np.minimum(first + (x - inner) / END_RADIUS, 0.99)
        cosine = lambda sine: np.sqrt((1 - sine) * (1 + sine))
        across = arc(self.section, y) - self.worn
        across = 0.5 * (across + np.hypot(across, WORN_EDGE * self.worn))
        return arc(self.rocker, inner) + END_RADIUS * (cosine(first) - cosine(last)) + across


def response(x_edges, y_edges):
    """Displacement at every rectangle's centre from unit pressure on every rectangle and its mirror images."""
    x, y = (0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges))
    total = np.zeros((len(x), len(y), len(x), len(y)))

    def logarithm(a, b, r):
        """ln(a + r), from b^2 / (r - a) for a < 0 to avoid cancellation."""
        return np.where(a >= 0, np.log(np.where(a >= 0, a + r, 1)), 2 * np.log(np.abs(b)) - np.log(np.where(a < 0, r - a, 1)))

    for mirror_x in (1, -1):
        for mirror_y in (1, -1):
            across = [x[:, None] - mirror_x * edges[None] for edges in (x_edges[1:], x_edges[:-1])]
            along = [y[:, None] - mirror_y * edges[None] for edges in (y_edges[1:], y_edges[:-1])]
            across, along = ([np.minimum(*pair), np.maximum(*pair)] for pair in (across, along))
            for p in (0, 1):
                for q in (0, 1):
                    a, b = across[p][:, None, :, None], along[q][None, :, None, :]
                    r = np.hypot(a, b)
                    total += (1 if p == q else -1) * (a * logarithm(b, a, r) + b * logarithm(a, b, r))
    return total.reshape(len(x) * len(y), -1) / (np.pi * CONTACT_MODULUS), x, y


def pressures(runner, force, curvature, x_edges, y_edges):
    matrix, x, y = response(x_edges, y_edges)
    grid = np.meshgrid(x, y, indexing="ij")
    track = curvature * grid[0] ** 2 / (1 + np.sqrt(1 - (curvature * grid[0]) ** 2))
    gap = (runner.height(*grid) - track).ravel()
    area = np.outer(np.diff(x_edges), np.diff(y_edges)).ravel()
    inside = np.ones(len(gap), bool)
    for _ in range(100):
        contact = np.flatnonzero(inside)
        solved = np.linalg.solve(matrix[np.ix_(contact, contact)], np.stack([np.ones(len(contact)), gap[contact]], 1))
        approach = (force / 4 + area[contact] @ solved[:, 1]) / (area[contact] @ solved[:, 0])
        pressure = np.zeros(len(gap))
        pressure[contact] = approach * solved[:, 0] - solved[:, 1]
        sunk = gap - approach + matrix @ pressure < 0
        found = np.where(inside, pressure > 0, sunk)
        if (found == inside).all():
            return x, y, pressure.reshape(len(x), len(y))
        inside = found
    raise SystemExit("the contact set does not converge")


def graded(corner, smallest, even, largest, reach):
    """Edges from 0 to `corner + reach`, spaced by `smallest` within `even` of the corner, then growing by a fifth."""
    def steps(distance):
        edges, step = [0.0], smallest
        while edges[-1] < distance:
            step = min(1.2 * step, largest) if edges[-1] >= even else step
            edges.append(edges[-1] + step)
        return np.array(edges)

    before = corner - steps(corner)
    before = before[before > 0.3 * largest * 0.1]
    return np.concatenate([[0.0], before[::-1], corner + steps(reach)[1:]])


def peak(rocker, section, worn, force, curvature):
    runner = Runner(rocker, section, worn)
    if worn > 0:
        x_edges, y_edges = np.linspace(0, 0.0255, 17), np.linspace(0, 1.5e-4, 121)
        x, y, p = pressures(runner, force, curvature, x_edges, y_edges)
    else:
        half_width = 4e-5 * np.sqrt(force / 1000 * section / 0.005)
        while True:
            reach = 1.5e-3 * np.sqrt(force / 1000)
            x_edges = graded(runner.corner, 0.25 * half_width, 8 * half_width, 0.02, reach)
            x, y, p = pressures(runner, force, curvature, x_edges, np.linspace(0, half_width, 19))
            if (p[:, -1] == 0).all() and (p[-1] == 0).all():
                break
            half_width *= 1.2

    def at_the_plane(inner, outer, a, b):
        """Pressure at the mirror plane, from the parabola of p^2 through its values at a and b."""
        return np.sqrt(np.maximum(inner**2 + (inner**2 - outer**2) * a * a / (b * b - a * a), 0))

    if worn > 0:
        row = at_the_plane(p[0], p[1], x[0], x[1])
        k = row.argmax()
        a, b, c = row[k - 1 : k + 2]
        return b - (c - a) ** 2 / (8 * (c - 2 * b + a))
    return at_the_plane(p[:, 0], p[:, 1], y[0], y[1]).max()


print("rocker_radius_m,section_radius_m,worn_m,fz_n,curvature_1pm,p_max_pa")
for rocker, section, worn, force, shift in [
    (30.0, 0.005, 0, 200.0, -3e-9),
    (30.0, 0.005, 0, 400.0, -3.5e-9),
    (30.0, 0.005, 0, 1000.0, -2.5e-9),
    (30.0, 0.005, 0, 1000.0, -3.5e-9),
    (30.0, 0.005, 0, 2500.0, -2e-9),
    (30.0, 0.005, 0, 8000.0, -5e-9),
    (30.0, 0.005, 0, 8000.0, 1e-9),
    (35.0, 0.006, 0, 400.0, -2e-9),
    (35.0, 0.006, 0, 2500.0, -3.5e-9),
    (30.0, 0.005, 5e-7, 1000.0, None),
]:
    curvature = 0.0 if shift is None else 1 / rocker + shift * force
    p_max = peak(rocker, section, worn, force, curvature)
    print(f"{rocker:g},{section:g},{worn:g},{force:g},{curvature:.12g},{p_max:.5e}", flush=True)
