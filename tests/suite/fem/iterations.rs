//! Iterations of conjugate gradients on a slender steel with and without beam modes.

use kufe_fem::{BeamModes, Body, ElementKind, Factor, FixedFaces, Material, MatrixFree, assemble};
use kufe_mesh::TensorGrid;
use kufe_tests::fem::cg;
use kufe_tests::fem::mapped::MappedPreconditioner;

/// Iterations and relative energy error for a luge steel, 0.6 m x 20 mm x 8 mm, clamped at one end.
/// The underside is rounded across by `round` of its height.
fn iterations(
    kind: ElementKind,
    cells: [usize; 3],
    round: f64,
    knots: Option<usize>,
) -> (usize, f64) {
    let (length, width, height) = (0.6, 0.02, 0.008);
    let axis =
        |n: usize, size: f64| -> Vec<f64> { (0..=n).map(|i| size * i as f64 / n as f64).collect() };
    let grid = TensorGrid {
        x: axis(cells[0], length),
        y: axis(cells[1], width),
        z: axis(cells[2], height),
    };
    let mut mesh = grid.hex_mesh();
    for p in &mut mesh.points {
        let across = 2.0 * p[1] / width - 1.0;
        p[2] += round * height * across * across * (1.0 - p[2] / height);
    }
    let steel = Material::new(210e9, 0.3).unwrap();
    let points = mesh.points.clone();
    let body = Body::uniform(mesh, steel, kind).unwrap();
    let fixed: Vec<bool> = points.iter().flat_map(|p| [p[0] == 0.0; 3]).collect();
    let mut operator = MatrixFree::new(&body);
    let mut apply = |u: &[f64], out: &mut [f64]| {
        operator.apply(u, out);
        out.iter_mut()
            .zip(&fixed)
            .filter(|(_, fixed)| **fixed)
            .for_each(|(out, _)| *out = 0.0);
    };
    let end: FixedFaces = [[[true, false], [false; 2], [false; 2]]; 3];
    let mut preconditioner = MappedPreconditioner::new(&grid, steel, end, 0.0);
    preconditioner.beam = knots.map(|knots| {
        let axis = [width / 2.0, height / 2.0];
        BeamModes::new(
            points.clone(),
            &grid.x,
            knots,
            axis,
            fixed.clone(),
            &mut apply,
        )
        .unwrap()
    });
    // A load with components in all modes.
    let mut loads: Vec<f64> = (0..body.dofs())
        .map(|i| (i as f64 * 0.61).sin() + 0.1)
        .collect();
    loads
        .iter_mut()
        .zip(&fixed)
        .filter(|(_, fixed)| **fixed)
        .for_each(|(f, _)| *f = 0.0);
    let mut u = vec![0.0; body.dofs()];
    let options = cg::Options {
        stop: cg::Stop::Energy(1e-6),
        ..Default::default()
    };
    let history = cg::solve(
        &mut apply,
        |r, z| preconditioner.apply(r, z),
        &loads,
        &mut u,
        &mut cg::Workspace::default(),
        &options,
    )
    .unwrap();

    let mut constraints = kufe_fem::Constraints::new(points.len());
    constraints
        .clamp((0..points.len()).filter(|&node| points[node][0] == 0.0))
        .unwrap();
    let map = constraints.dof_map();
    let stiffness = assemble(&body);
    let factor = Factor::of_body(&stiffness, &map, &points).unwrap();
    let exact = factor.displacement(&stiffness, &constraints, &map, &loads);
    let energy = |v: &[f64]| {
        let mut image = vec![0.0; v.len()];
        stiffness.apply(v, &mut image);
        v.iter().zip(&image).map(|(a, b)| a * b).sum::<f64>().sqrt()
    };
    let error: Vec<f64> = u.iter().zip(&exact).map(|(a, b)| a - b).collect();
    (history.iterations, energy(&error) / energy(&exact))
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn beam_modes_keep_slender_steel_below_45_iterations_at_every_refinement_and_with_either_element() {
    println!(
        "element, cells, rounding: iterations without and with beam modes on 25 knots, energy error"
    );
    for kind in [ElementKind::Hex8, ElementKind::Hex8Incompatible] {
        for round in [0.0, 0.4] {
            for cells in [[30, 4, 2], [60, 8, 4], [120, 12, 6]] {
                let (without, _) = iterations(kind, cells, round, None);
                let (with, error) = iterations(kind, cells, round, Some(25));
                println!("{kind:?} {cells:?} {round}: {without} {with} {error:.1e}");
                assert!(with <= 45, "{kind:?} {cells:?} {round}: {with}");
                assert!(
                    5 * with < without,
                    "{kind:?} {cells:?} {round}: {without} {with}"
                );
                assert!(error < 1e-6, "{kind:?} {cells:?} {round}: {error}");
            }
        }
    }
}
