"""One Hertz contact by GetFEM (Debian package python3-getfem), quadratic hexahedra on a graded quarter block, one process a measurement.

    /usr/bin/python3 getfem_hertz.py CELLS    # cells over the half width and over the half length of the patch

In millimetres and megapascals: its residuals know no scale. Prints the true error of p_max, the seconds of building and solving, and the unknowns. The mesh is sized by Hertz' formulas
and pressed in by the approach of Hertz; p_max is compared with Hertz' for the force that results.
"""
import sys
import time

import getfem as gf
import numpy as np

from hertz import NU, elliptic
from hertz import E as PASCALS
from hertz import hertz as in_metres

E, ROCKER, SECTION, FORCE, FAR = 1e-6 * PASCALS, 30e3, 5.0, 1000.0, 300.0


def hertz(force):
    """Half length, half width [mm] and peak pressure [MPa]."""
    a, b, p = in_metres(1e-3 * ROCKER, force)
    return 1e3 * a, 1e3 * b, 1e-6 * p


def axis(half, cells):
    """Even to a quarter outside the patch, then by a factor of 2.5 a cell to the far face."""
    step = half / cells
    nodes = [step * i for i in range(cells + cells // 4 + 1)]
    while nodes[-1] < FAR:
        step *= 2.5
        nodes.append(nodes[-1] + step)
    return np.array(nodes)


def approach(a, b, p):
    """Hertz' approach of a half-space [mm] (K. L. Johnson, Contact Mechanics, section 4.2): p b K / E*."""
    return p * b * elliptic(1 - (b / a) ** 2)[0] * (1 - NU**2) / E


def main():
    cells = int(sys.argv[1])
    gf.util_trace_level(0)
    gf.util_warning_level(0)
    a, b, p = hertz(FORCE)
    begun = time.perf_counter()
    mesh = gf.Mesh("cartesian", axis(a, cells), axis(b, cells), -axis(b, cells)[::-1])
    top, symmetry, far = 1, 2, 3
    outer = lambda *n: mesh.outer_faces_with_direction(list(n), 0.01)
    mesh.set_region(top, outer(0, 0, 1))
    mesh.set_region(symmetry, np.hstack([outer(-1, 0, 0), outer(0, -1, 0)]))
    mesh.set_region(far, np.hstack([outer(1, 0, 0), outer(0, 1, 0), outer(0, 0, -1)]))
    displacement, scalar = gf.MeshFem(mesh, 3), gf.MeshFem(mesh, 1)
    displacement.set_classical_fem(2)
    scalar.set_classical_fem(2)
    pressure = gf.MeshFem(mesh, 1)
    pressure.set_classical_fem(1)
    integration = gf.MeshIm(mesh, 4)
    model = gf.Model("real")
    model.add_fem_variable("u", displacement)
    model.add_initialized_data("lame", [E * NU / ((1 + NU) * (1 - 2 * NU))])
    model.add_initialized_data("shear", [E / (2 * (1 + NU))])
    model.add_isotropic_linearized_elasticity_brick(integration, "u", "lame", "shear")
    model.add_linear_term(integration, f"{1e4 * E / b} * (u . Normal) * (Test_u . Normal)", symmetry)
    model.add_Dirichlet_condition_with_simplification("u", far)
    x, y, z = scalar.basic_dof_nodes()
    gap = x**2 / (2 * ROCKER) + y**2 / (2 * SECTION) - approach(a, b, p) - z
    model.add_initialized_fem_data("gap", scalar, gap)
    model.add_initialized_data("r", [E / b])
    model.add_filtered_fem_variable("pressure", pressure, top)
    model.add_integral_contact_with_rigid_obstacle_brick(integration, "u", "pressure", "gap", "r", top, 1)
    model.solve("max_res", 1e-9, "max_iter", 60, "lsearch", "simplest", "alpha min", 0.8)
    found = -model.variable("pressure")
    force = -4 * gf.asm_generic(integration, 0, "pressure", top, model)
    seconds = time.perf_counter() - begun
    print(abs(found.max() / hertz(force)[2] - 1), seconds, model.nbdof())


main()
