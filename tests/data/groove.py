"""Grooves of runners that slide on a yielding half-space, by boundary elements.

    python groove.py > groove.csv

Rectangles of uniform pressure, the displacement at their centres from A. E. H. Love's integral (1929), mirrored at y = 0. At a given
approach, sweeps from the front to the back: each rectangle takes the pressure between 0 and the hardness that closes its gap over the
groove it meets, and the remaining penetration deepens the groove. The approach follows from the load by bisection. The edges of
the groove and the front of the patch fall between rectangles.
"""
import numpy as np

E, NU = 9e9, 0.33
CONTACT_MODULUS = E / (1 - NU**2)
CELLS_X, CELLS_Y = 66, 13
ROWS_IN, COLUMNS_AHEAD = 10, 42


def response(x_edges, y_edges):
    """Displacement at every rectangle's centre from unit pressure on every rectangle and its mirror image, along x by the distance
    alone: [distance, y, y']."""
    dx = x_edges[1] - x_edges[0]
    y = 0.5 * (y_edges[1:] + y_edges[:-1])
    distance = dx * np.arange(-(CELLS_X - 1), CELLS_X)

    def logarithm(a, b, r):
        return np.where(a >= 0, np.log(np.where(a >= 0, a + r, 1)), 2 * np.log(np.abs(b)) - np.log(np.where(a < 0, r - a, 1)))

    total = np.zeros((len(distance), len(y), len(y)))
    for mirror in (1, -1):
        sides = [y[:, None] - mirror * edges[None] for edges in (y_edges[1:], y_edges[:-1])]
        sides = [np.minimum(*sides), np.maximum(*sides)]
        ends = [distance - dx / 2, distance + dx / 2]
        for p in (0, 1):
            for q in (0, 1):
                a, b = ends[p][:, None, None], sides[q][None]
                r = np.hypot(a, b)
                total += (1 if p == q else -1) * (a * logarithm(b, a, r) + b * logarithm(a, b, r))
    return total / (np.pi * CONTACT_MODULUS)


def swept(kernel, height, hardness, approach, pressure):
    """Pressures and groove at an approach by Gauss-Seidel sweeps; the first axis is x, the front last."""
    deflection = np.array([
        sum(kernel[i - k + CELLS_X - 1] @ pressure[k] for k in range(CELLS_X)) for i in range(CELLS_X)
    ])
    for _ in range(4000):
        largest, depth = 0.0, np.zeros(CELLS_Y)
        for i in reversed(range(CELLS_X)):
            for j in range(CELLS_Y):
                own = kernel[CELLS_X - 1, j, j]
                gap = height[i, j] - approach + deflection[i, j] + depth[j]
                trial = pressure[i, j] - gap / own
                depth[j] += own * max(trial - hardness, 0.0)
                change = min(max(trial, 0.0), hardness) - pressure[i, j]
                if change:
                    pressure[i, j] += change
                    deflection += change * kernel[CELLS_X - 1 - i : 2 * CELLS_X - 1 - i, :, j]
                    largest = max(largest, abs(change))
        if largest < 1e-7 * hardness:
            return pressure, depth
    raise RuntimeError("the sweeps do not converge")


def groove(rocker, section, force, hardness, width, front):
    """Depth, ploughing force over load, load ahead, half-width and front; the grid follows from the expected half-width and front."""
    y_edges = width / ROWS_IN * np.arange(CELLS_Y + 1)
    dx = front / COLUMNS_AHEAD
    x_edges = dx * (np.arange(CELLS_X + 1) - (CELLS_X - 3 - COLUMNS_AHEAD))
    x, y = (0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges))
    height = x[:, None] ** 2 / (2 * rocker) + y[None] ** 2 / (2 * section)
    kernel = response(x_edges, y_edges)
    area = 2 * dx * (y_edges[1] - y_edges[0])
    low, high = 0.5 * front**2 / (2 * rocker), 1.5 * front**2 / (2 * rocker)
    pressure = np.where(height < 0.5 * (low + high), 0.5 * hardness, 0.0)
    for _ in range(30):
        approach = 0.5 * (low + high)
        pressure, depth = swept(kernel, height, hardness, approach, pressure)
        carried = pressure.sum() * area
        if abs(carried / force - 1) < 1e-5:
            break
        low, high = (approach, high) if carried < force else (low, approach)
    ploughing = 2 * hardness * depth.sum() * (y_edges[1] - y_edges[0]) / force
    ahead = (pressure.sum(axis=1) * x).sum() * area / force
    inside = depth > 0
    curve = np.polyfit(y[inside] ** 2, depth[inside], 2)
    side = np.sqrt(min(root.real for root in np.roots(curve) if abs(root.imag) < 1e-12 and root.real > 0))
    touched = np.flatnonzero(pressure[:, 0] > 0)[-1]
    penetration = lambda i: approach - height[i, 0] - sum(kernel[i - k + CELLS_X - 1, 0] @ pressure[k] for k in range(CELLS_X))
    inside, outside = penetration(touched), penetration(touched + 1)
    tip = x[touched] + dx * inside / (inside - outside) if inside > outside else x[touched] + dx / 2
    return np.polyval(curve, 0.0), ploughing, ahead, side, tip


print("rocker_radius_m,section_radius_m,fz_n,hardness_pa,depth_m,mu_ploughing,load_ahead_m,side_m,front_m")
for rocker, section, force, hardness in ((30, 0.004, 950, 17.7e6), (20, 0.0055, 1500, 20.7e6)):
    length = np.sqrt(2 * force * np.sqrt(rocker / section) / (np.pi * hardness))
    side, front = 0.9 * length * np.sqrt(section / rocker), 0.9 * length
    for _ in range(3):
        depth, ploughing, ahead, side, front = groove(rocker, section, force, hardness, side, front)
    print(f"{rocker},{section},{force},{hardness:.4e},{depth:.4e},{ploughing:.4e},{ahead:.4e},{side:.4e},{front:.4e}")
