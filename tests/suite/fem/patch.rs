//! Constant strain and rigid motion of distorted elements.

use kufe_fem::{Body, Constraints, ElementKind, Material, assemble, hex8, stress_at};
use kufe_tests::fem::statics::{Solver, equilibrium};
use kufe_tests::meshes::{block, nodes_where, shake};

const KINDS: [ElementKind; 4] = [
    ElementKind::Hex8,
    ElementKind::Hex8Incompatible,
    ElementKind::Hex8Axial,
    ElementKind::Hex8Dilatation,
];
const CELLS: [usize; 3] = [4, 3, 5];
const SIZE: [f64; 3] = [1.0, 0.6, 2.0];

fn distorted(kind: ElementKind) -> Body {
    let mut mesh = block(CELLS, SIZE);
    // The axial element requires cells with faces normal to x.
    let along = if kind == ElementKind::Hex8Axial {
        0.0
    } else {
        0.3
    };
    shake(&mut mesh, CELLS, SIZE, [along, 0.3, 0.3]);
    Body::uniform(mesh, Material::new(9.0e9, 0.33).unwrap(), kind).unwrap()
}

/// Irons' patch test: a linear displacement on the boundary gives the same linear displacement and
/// constant stress inside.
#[test]
fn patch_test_on_distorted_hexahedra_to_1e_12() {
    let gradient = [
        [1.0e-3, 4.0e-4, -2.0e-4],
        [3.0e-4, -6.0e-4, 5.0e-4],
        [1.0e-4, 7.0e-4, 8.0e-4],
    ];
    for kind in KINDS {
        let body = distorted(kind);
        let mesh = body.mesh();
        let exact: Vec<f64> = mesh
            .points
            .iter()
            .flat_map(|p| gradient.map(|g| g[0] * p[0] + g[1] * p[1] + g[2] * p[2]))
            .collect();
        let boundary = nodes_where(mesh, |p| (0..3).any(|a| p[a] == 0.0 || p[a] == SIZE[a]));
        let inner = mesh.points.len() - boundary.len();
        assert_eq!(inner, (CELLS[0] - 1) * (CELLS[1] - 1) * (CELLS[2] - 1));
        let mut constraints = Constraints::new(mesh.points.len());
        for node in boundary {
            for c in 0..3 {
                constraints.prescribe(node, c, exact[3 * node + c]).unwrap();
            }
        }
        let loads = vec![0.0; body.dofs()];
        let state = equilibrium(&body, &constraints, &loads, Solver::Cholesky).unwrap();
        let size = exact.iter().fold(0.0f64, |s, u| s.max(u.abs()));
        for (found, exact) in state.displacement.iter().zip(&exact) {
            assert!(
                (found - exact).abs() < 1e-12 * size,
                "{kind:?}: {found} {exact}"
            );
        }
        let g = gradient;
        let stress = body.sections()[0].material.stress([
            g[0][0],
            g[1][1],
            g[2][2],
            g[1][2] + g[2][1],
            g[0][2] + g[2][0],
            g[0][1] + g[1][0],
        ]);
        let largest = stress.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        let cells = 0..body.mesh().cells.len();
        let points = cells.flat_map(|cell| hex8::gauss_points().map(|xi| (cell, xi)));
        for (cell, xi) in points {
            let found = stress_at(&body, cell, &state.displacement, xi);
            for i in 0..6 {
                // Strains are differences over a fifth of the block: ten times the rounding error.
                assert!(
                    (found[i] - stress[i]).abs() < 1e-11 * largest,
                    "{kind:?} {i}"
                );
            }
        }
    }
}

#[test]
fn null_space_is_the_six_rigid_motions() {
    for kind in KINDS {
        let body = distorted(kind);
        let stiffness = assemble(&body);
        let size = stiffness.diagonal().iter().fold(0.0f64, |s, v| s.max(*v));
        for axis in 0..3 {
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut motions = [vec![0.0; body.dofs()], vec![0.0; body.dofs()]];
            for (node, x) in body.mesh().points.iter().enumerate() {
                motions[0][3 * node + axis] = 1.0;
                motions[1][3 * node + p] = -x[q];
                motions[1][3 * node + q] = x[p];
            }
            for motion in &motions {
                let mut force = vec![0.0; body.dofs()];
                stiffness.apply(motion, &mut force);
                let largest = force.iter().fold(0.0f64, |s, v| s.max(v.abs()));
                assert!(largest < 1e-13 * size, "{kind:?}: {largest} of {size}");
            }
        }
        // Six components fixed at points that are not collinear prevent every rigid motion, so
        // Cholesky succeeds; with five it does not.
        let fixed = [
            (0, 0),
            (0, 1),
            (0, 2),
            (CELLS[0], 1),
            (CELLS[0], 2),
            (5 * (CELLS[1]), 2),
        ];
        let solve = |count: usize| {
            let mut constraints = Constraints::new(body.node_count());
            for &(node, component) in &fixed[..count] {
                constraints.prescribe(node, component, 0.0).unwrap();
            }
            let mut loads = vec![0.0; body.dofs()];
            // A moment about the line.
            loads[3 * 7 + 2] = 1.0;
            equilibrium(&body, &constraints, &loads, Solver::Cholesky)
        };
        assert!(solve(6).is_ok());
        let compliant = match solve(5) {
            Err(kufe_fem::Error::NotPositiveDefinite { .. }) => true,
            // With a tiny positive pivot due to rounding, the displacement along the free motion is
            // very large.
            Ok(state) => state.displacement.iter().any(|u| u.abs() > 1.0),
            Err(other) => panic!("{other}"),
        };
        assert!(compliant);
    }
}
