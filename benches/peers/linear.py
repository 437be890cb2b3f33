"""One linear solve of elasticity on a graded block: kufe, faer's sparse Cholesky, pyamg's smoothed aggregation.

    python benches/peers/linear.py target/release/solver

The block, its supports and its load are those of `solver linear`; pyamg's matrix is put together from the 1-D ones here.
faer factorises what kufe assembles, ordered by nested dissection; kufe and pyamg solve to 1e-8.
"""
import resource
import subprocess
import sys
import time

import numpy as np
import pyamg
import scipy.sparse as sp

CELLS = 40
E, NU, PATCH = 9.0e9, 0.33, (0.0251, 0.000137)


def axis(half):
    """Even to the patch's half width, then in geometric progression to 0.3 m."""
    even = CELLS // 3
    ratio = (0.3 / half) ** (1 / (CELLS - even))
    return np.concatenate([half * np.arange(even + 1) / even, half * ratio ** np.arange(1, CELLS - even + 1)])


def matrices(nodes):
    """Stiffness, mass and gradient (int phi_i' phi_j) of linear elements."""
    n, h = len(nodes), np.diff(nodes)
    build = lambda a, b, c, d: sp.diags([np.r_[a, 0] + np.r_[0, d], b, c], [0, 1, -1], shape=(n, n)).tocsr()
    half = np.full(n - 1, 0.5)
    return build(1 / h, -1 / h, -1 / h, 1 / h), build(h / 3, h / 6, h / 6, h / 3), build(-half, -half, half, half)


def main():
    solver = sys.argv[1]
    ask = lambda what: subprocess.run([solver, what, str(CELLS)], check=True, capture_output=True, text=True).stdout.split()
    dofs, iterations, set_up, seconds, peak = map(float, ask("linear"))
    print("### One linear solve: kufe, a direct solver and algebraic multigrid, aspect ratio over 100\n")
    print("| program | unknowns | iterations | set-up and solve | peak memory |")
    print("|---|---|---|---|---|")
    print(f"| kufe, energy error 1e-8 | {dofs:.0f} | {iterations:.0f} | {set_up + seconds:.2f} s | {peak / 1e9:.2f} GB |", flush=True)
    direct_dofs, assembling, factorising, solving, direct_peak = map(float, ask("direct"))
    total = assembling + factorising + solving
    print(f"| faer, Cholesky by nested dissection ({factorising:.1f} s factor) | {direct_dofs:.0f} | | {total:.1f} s | {direct_peak / 1e9:.2f} GB |",
          flush=True)
    x, y, z = axis(PATCH[0]), axis(PATCH[1]), -axis(PATCH[1])[::-1]
    lam, mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
    k, m, d = zip(*(matrices(nodes) for nodes in (x, y, z)))
    kron = lambda f: sp.kron(f[2], sp.kron(f[1], f[0]))

    def block(c, e):
        factors = list(m)
        if c == e:
            total = 0
            for a in range(3):
                one = list(m)
                one[a] = (lam + 2 * mu if a == c else mu) * k[a]
                total = total + kron(one)
            return total
        factors[c], factors[e] = lam * d[c], d[e].T
        first = kron(factors)
        factors[c], factors[e] = mu * d[c].T, d[e]
        return first + kron(factors)

    n = len(x) * len(y) * len(z)
    stiffness = sp.bmat([[block(c, e) for e in range(3)] for c in range(3)]).tocsr()
    zz, yy, xx = np.meshgrid(z, y, x, indexing="ij")
    points = np.stack([xx, yy, zz], -1).reshape(n, 3)
    fixed = [
        (points[:, 0] == x[-1]) | (points[:, 1] == y[-1]) | (points[:, 2] == z[0]) | ((points[:, c] == 0) if c < 2 else False)
        for c in range(3)
    ]
    # Node by node in blocks of three, as aggregation wants it, without fully fixed nodes; a single fixed unknown stays.
    fixed = np.stack(fixed, 1)
    kept = np.repeat(~fixed.all(1), 3)
    fixed = fixed.ravel()
    order = np.arange(3 * n).reshape(3, n).T.ravel()
    stiffness = stiffness[order][:, order]
    free = sp.diags((~fixed).astype(float))
    stiffness = free @ stiffness @ free + sp.diags(np.where(fixed, stiffness.diagonal(), 0.0))
    stiffness = stiffness.tocsr()[kept][:, kept]
    inside = np.clip(1 - (xx[-1] / PATCH[0]) ** 2 - (yy[-1] / PATCH[1]) ** 2, 0, None)
    load = np.zeros(3 * n)
    lumped = lambda nodes: np.r_[np.diff(nodes), 0] / 2 + np.r_[0, np.diff(nodes)] / 2
    load[3 * n - inside.size :] = (-1e8 * np.sqrt(inside) * np.outer(lumped(y), lumped(x))).ravel()
    load = np.where(fixed, 0.0, load[order])[kept]
    rigid = np.zeros((3 * n, 6))
    for c in range(3):
        rigid[c::3, c] = 1
    rigid[1::3, 3], rigid[2::3, 3] = -points[:, 2], points[:, 1]
    rigid[0::3, 4], rigid[2::3, 4] = points[:, 2], -points[:, 0]
    rigid[0::3, 5], rigid[1::3, 5] = -points[:, 1], points[:, 0]
    rigid = (rigid * ~fixed[:, None])[kept]
    # The best of what was tried: a diagonal of ones, and nodes joined only where they hang together strongly.
    scale = 1 / np.sqrt(stiffness.diagonal())
    stiffness = (sp.diags(scale) @ stiffness @ sp.diags(scale)).tobsr((3, 3))
    load, rigid = scale * load, rigid / scale[:, None]
    rigid /= np.abs(rigid).max(0)
    smoother = ("block_gauss_seidel", {"sweep": "symmetric"})
    begun = time.perf_counter()
    hierarchy = pyamg.smoothed_aggregation_solver(
        stiffness,
        B=rigid,
        strength=("symmetric", {"theta": 0.25}),
        smooth=("energy", {"krylov": "cg", "degree": 2, "maxiter": 2}),
        improve_candidates=[("block_gauss_seidel", {"sweep": "symmetric", "iterations": 4}), None],
        presmoother=smoother,
        postsmoother=smoother,
        max_coarse=500,
    )
    theirs_set_up = time.perf_counter() - begun
    residuals = []
    hierarchy.solve(load, tol=1e-8, accel="cg", maxiter=150, residuals=residuals)
    theirs = time.perf_counter() - begun
    reached = residuals[-1] / residuals[0]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(f"| pyamg, residual {reached:.0e} ({theirs_set_up:.1f} s set-up) | {(~fixed).sum()} | {len(residuals) - 1} | {theirs:.1f} s | {memory / 1e9:.2f} GB |")


main()
