//! Stresses against closed forms.

use std::f64::consts::FRAC_PI_2;

use kufe_fem::{Body, Constraints, ElementKind, Material, boussinesq, nodal_stresses};
use kufe_tests::fem::closed_form::{ThickCylinder, boussinesq_stress};
use kufe_tests::fem::loads::add_pressure;
use kufe_tests::fem::statics::{Solver, equilibrium};
use kufe_tests::meshes::{block, faces_where, fitted_slope, nodes_where};

/// Relative errors of displacement and hoop stress at the inner wall of a quarter tube in plane
/// strain.
fn tube(n: usize, kind: ElementKind, poissons_ratio: f64) -> [f64; 2] {
    let exact = ThickCylinder {
        inner_radius: 0.1,
        outer_radius: 0.2,
        inner_pressure: 10.0e6,
        outer_pressure: 3.0e6,
    };
    let material = Material::new(210e9, poissons_ratio).unwrap();
    let grid = block([n, 2 * n, 1], [1.0, 1.0, 0.02]);
    let mut mesh = grid.clone();
    for p in &mut mesh.points {
        let r = exact.inner_radius * (exact.outer_radius / exact.inner_radius).powf(p[0]);
        let angle = FRAC_PI_2 * p[1];
        *p = [r * angle.cos(), r * angle.sin(), p[2]];
    }
    let mut constraints = Constraints::new(mesh.points.len());
    constraints
        .symmetry(nodes_where(&grid, |p| p[1] == 0.0), 1)
        .unwrap();
    constraints
        .symmetry(nodes_where(&grid, |p| p[1] == 1.0), 0)
        .unwrap();
    constraints.symmetry(0..mesh.points.len(), 2).unwrap();
    let inner = faces_where(&grid, |p| p[0] == 0.0);
    let outer = faces_where(&grid, |p| p[0] == 1.0);
    let body = Body::uniform(mesh, material, kind).unwrap();
    let mut loads = vec![0.0; body.dofs()];
    add_pressure(body.mesh(), &inner, |_| exact.inner_pressure, &mut loads);
    add_pressure(body.mesh(), &outer, |_| exact.outer_pressure, &mut loads);
    let u = equilibrium(&body, &constraints, &loads, Solver::Cholesky)
        .unwrap()
        .displacement;
    let stress = nodal_stresses(&body, &u);
    // At 45 degrees the hoop stress is (s_xx + s_yy) / 2 - s_xy.
    let node = nodes_where(&grid, |p| p[0] == 0.0 && p[1] == 0.5 && p[2] == 0.0)[0];
    let radial = (u[3 * node].powi(2) + u[3 * node + 1].powi(2)).sqrt();
    let hoop = (stress[node][0] + stress[node][1]) / 2.0 - stress[node][5];
    [
        (radial / exact.displacement(0.1, material) - 1.0).abs(),
        (hoop / exact.stress(0.1, material)[1] - 1.0).abs(),
    ]
}

#[test]
fn lame_cylinder_converges_with_slope_2_in_displacement_and_about_1_in_wall_stress() {
    let sizes = [8, 16, 32];
    let h = sizes.map(|n| 1.0 / n as f64);
    for kind in [
        ElementKind::Hex8,
        ElementKind::Hex8Incompatible,
        ElementKind::Hex8Dilatation,
    ] {
        let errors = sizes.map(|n| tube(n, kind, 0.3));
        let slopes = [0, 1].map(|i| fitted_slope(&h, &errors.map(|e| e[i])));
        println!("{kind:?}: slopes {slopes:.2?}; relative errors {errors:?}");
        assert!(slopes[0] > 1.9, "{kind:?} {slopes:?}");
        // Stresses extrapolated from Gauss points to a wall converge with first order; the slope
        // approaches 1 from below.
        assert!(slopes[1] > 0.75, "{kind:?} {slopes:?}");
        assert!(
            errors[2][0] < 2e-3 && errors[2][1] < 0.02,
            "{kind:?} {errors:?}"
        );
    }
}

/// The trilinear element gives less than 60 % of the displacement at a Poisson's ratio of 0.4999.
#[test]
fn dilatation_element_does_not_lock_at_poissons_ratios_up_to_0_4999() {
    for ratio in [0.3, 0.45, 0.49, 0.499, 0.4999] {
        let [error, _] = tube(16, ElementKind::Hex8Dilatation, ratio);
        println!("{ratio}: {error:.2e}");
        assert!(error < 1e-3, "{ratio}: {error}");
    }
    let [locked, _] = tube(16, ElementKind::Hex8, 0.4999);
    assert!(locked > 0.4, "{locked}");
}

/// Largest error of a stress component over the largest component at its node, in a block of a
/// half-space near a point load, with Boussinesq's displacements prescribed on its boundary.
fn below_a_point_load(n: usize) -> f64 {
    let ice = Material::new(9.0e9, 0.33).unwrap();
    let load = 1000.0;
    let grid = block([n; 3], [1.0; 3]);
    let mut mesh = grid.clone();
    for p in &mut mesh.points {
        *p = [p[0] - 0.3, p[1] - 0.4, p[2] - 1.5];
    }
    let body = Body::uniform(mesh, ice, ElementKind::Hex8).unwrap();
    let mut constraints = Constraints::new(body.node_count());
    for node in nodes_where(&grid, |p| p.iter().any(|&c| c == 0.0 || c == 1.0)) {
        let u = boussinesq(body.mesh().points[node], load, ice);
        for (c, value) in u.into_iter().enumerate() {
            constraints.prescribe(node, c, value).unwrap();
        }
    }
    let loads = vec![0.0; body.dofs()];
    let state = equilibrium(&body, &constraints, &loads, Solver::Cholesky).unwrap();
    let stress = nodal_stresses(&body, &state.displacement);
    let mut worst = 0.0f64;
    // Away from the boundary.
    for node in nodes_where(&grid, |p| p.iter().all(|&c| (c - 0.5).abs() < 0.3)) {
        let exact = boussinesq_stress(body.mesh().points[node], load, ice);
        let size = exact.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for i in 0..6 {
            worst = worst.max((stress[node][i] - exact[i]).abs() / size);
        }
    }
    worst
}

#[test]
fn stresses_below_a_point_load_converge_to_boussinesq_with_slope_2() {
    let sizes = [8, 12, 20];
    let errors = sizes.map(below_a_point_load);
    let slope = fitted_slope(&sizes.map(|n| 1.0 / n as f64), &errors);
    println!("slope {slope:.2}; worst components {errors:?}");
    // Stresses averaged at inner nodes of a regular grid are superconvergent.
    assert!((slope - 2.0).abs() < 0.25, "{slope}");
    assert!(errors[2] < 0.015, "{errors:?}");
}
