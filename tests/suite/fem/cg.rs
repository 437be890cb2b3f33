//! Conjugate gradients, used for the verification of operators and preconditioners.

use kufe_tests::fem::cg::{Error, Jacobi, Options, Stop, Workspace, solve};

/// -(c u')' + u/10 on n points with a discontinuous coefficient.
fn laplacian(v: &[f64], out: &mut [f64]) {
    let n = v.len();
    let c = |i: usize| if i < n / 2 { 1.0 } else { 50.0 };
    for i in 0..n {
        let left = if i > 0 { v[i - 1] } else { 0.0 };
        let right = if i + 1 < n { v[i + 1] } else { 0.0 };
        out[i] = c(i) * (v[i] - left) + c(i + 1) * (v[i] - right) + 0.1 * v[i];
    }
}

fn right_hand_side(n: usize) -> Vec<f64> {
    (0..n).map(|i| 1.0 + (i as f64 * 0.3).sin()).collect()
}

#[test]
fn reported_residual_is_the_true_residual() {
    let n = 60;
    let b = right_hand_side(n);
    let mut x = vec![0.0; n];
    let mut diagonal = vec![0.0; n];
    for i in 0..n {
        let mut e = vec![0.0; n];
        e[i] = 1.0;
        let mut y = vec![0.0; n];
        laplacian(&e, &mut y);
        diagonal[i] = y[i];
    }
    let jacobi = Jacobi::new(&diagonal);
    let history = solve(
        laplacian,
        |r, z| jacobi.apply(r, z),
        &b,
        &mut x,
        &mut Workspace::default(),
        &Options::default(),
    )
    .unwrap();
    let mut y = vec![0.0; n];
    laplacian(&x, &mut y);
    let norm = |v: &[f64]| v.iter().map(|a| a * a).sum::<f64>().sqrt();
    let residual: Vec<f64> = b.iter().zip(&y).map(|(b, y)| b - y).collect();
    assert!(norm(&residual) / norm(&b) < 2e-10);
    assert_eq!(history.residuals.len(), history.iterations + 1);
    // In exact arithmetic n iterations are enough; rounding adds a few.
    assert!(history.iterations <= n + 10, "{}", history.iterations);
}

#[test]
fn energy_rule_bounds_the_energy_error_where_convergence_is_steady() {
    let n = 400;
    let b = right_hand_side(n);
    let identity = |r: &[f64], z: &mut [f64]| z.copy_from_slice(r);
    let run = |stop| {
        let mut x = vec![0.0; n];
        let options = Options {
            stop,
            ..Default::default()
        };
        solve(
            laplacian,
            identity,
            &b,
            &mut x,
            &mut Workspace::default(),
            &options,
        )
        .unwrap();
        x
    };
    let exact = run(Stop::Residual(1e-14));
    let energy = |v: &[f64]| {
        let mut y = vec![0.0; n];
        laplacian(v, &mut y);
        v.iter().zip(&y).map(|(a, b)| a * b).sum::<f64>().sqrt()
    };
    let rough = run(Stop::Energy(1e-4));
    let error: Vec<f64> = rough.iter().zip(&exact).map(|(a, b)| a - b).collect();
    assert!(
        energy(&error) < 1e-4 * energy(&exact),
        "{}",
        energy(&error) / energy(&exact)
    );
}

#[test]
fn errors_report_iterations_residual_and_energy() {
    let b = right_hand_side(50);
    let identity = |r: &[f64], z: &mut [f64]| z.copy_from_slice(r);
    let options = Options {
        stop: Stop::Residual(1e-12),
        max_iterations: 5,
    };
    let mut x = vec![0.0; 50];
    let error = solve(
        laplacian,
        identity,
        &b,
        &mut x,
        &mut Workspace::default(),
        &options,
    )
    .unwrap_err();
    assert!(
        matches!(error, Error::NotConverged { iterations: 5, residual, .. } if residual > 1e-12)
    );
    let negative = |v: &[f64], y: &mut [f64]| y.iter_mut().zip(v).for_each(|(y, v)| *y = -v);
    let error = solve(
        negative,
        identity,
        &b,
        &mut x,
        &mut Workspace::default(),
        &options,
    )
    .unwrap_err();
    assert!(matches!(error, Error::Indefinite { energy, .. } if energy < 0.0));
}

#[test]
fn a_zero_right_hand_side_needs_no_iteration() {
    let identity = |r: &[f64], z: &mut [f64]| z.copy_from_slice(r);
    let mut x = vec![0.0; 9];
    let history = solve(
        laplacian,
        identity,
        &[0.0; 9],
        &mut x,
        &mut Workspace::default(),
        &Options::default(),
    );
    assert_eq!(history.unwrap().iterations, 0);
    assert_eq!(x, [0.0; 9]);
}
