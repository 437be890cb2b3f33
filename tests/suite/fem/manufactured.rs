//! Convergence to a manufactured solution.

use kufe_fem::hex8::{self, Jacobian};
use kufe_fem::{Body, Constraints, ElementKind, Material, strain_at};
use kufe_tests::fem::loads::add_body_force;
use kufe_tests::fem::statics::{Solver, equilibrium};
use kufe_tests::meshes::{block, fitted_slope, nodes_where};

/// Two waves u = a sin(k . x + phase) [m], whose body force is
/// f = [(lambda + mu) (a . k) k + mu (k . k) a] sin(k . x + phase).
const WAVES: [([f64; 3], [f64; 3], f64); 2] = [
    ([1.0, -0.4, 0.6], [2.0, 1.0, -1.5], 0.3),
    ([0.3, 0.8, -0.5], [-1.0, 2.2, 1.7], 1.1),
];

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn displacement(x: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        WAVES
            .iter()
            .map(|(a, k, phase)| a[i] * (dot(*k, x) + phase).sin())
            .sum()
    })
}

fn strain(x: [f64; 3]) -> [f64; 6] {
    let h = |i: usize, j: usize| -> f64 {
        WAVES
            .iter()
            .map(|(a, k, phase)| a[i] * k[j] * (dot(*k, x) + phase).cos())
            .sum()
    };
    [
        h(0, 0),
        h(1, 1),
        h(2, 2),
        h(1, 2) + h(2, 1),
        h(0, 2) + h(2, 0),
        h(0, 1) + h(1, 0),
    ]
}

fn body_force(x: [f64; 3], m: Material) -> [f64; 3] {
    let (lambda, mu) = (m.lame_lambda(), m.shear_modulus());
    std::array::from_fn(|i| {
        WAVES
            .iter()
            .map(|(a, k, phase)| {
                ((lambda + mu) * dot(*a, *k) * k[i] + mu * dot(*k, *k) * a[i])
                    * (dot(*k, x) + phase).sin()
            })
            .sum()
    })
}

/// Errors in L2 and in energy by 3 x 3 x 3 Gauss points, at which neither element is
/// superconvergent.
fn errors(n: usize, kind: ElementKind) -> [f64; 2] {
    let mut mesh = block([n; 3], [1.0; 3]);
    for p in &mut mesh.points {
        // A smooth map that shears and stretches cells by up to a third.
        let [x, y, z] = *p;
        *p = [
            x + 0.08 * (3.0 * y).sin() * (2.0 * z).cos(),
            y + 0.07 * (2.5 * x + z).sin(),
            z + 0.06 * (3.0 * x * y).cos(),
        ];
    }
    let material = Material::new(2.5, 0.3).unwrap();
    let grid = block([n; 3], [1.0; 3]);
    let boundary = nodes_where(&grid, |p| (0..3).any(|a| p[a] == 0.0 || p[a] == 1.0));
    let body = Body::uniform(mesh, material, kind).unwrap();
    let mut constraints = Constraints::new(body.node_count());
    for node in boundary {
        let exact = displacement(body.mesh().points[node]);
        for (c, value) in exact.into_iter().enumerate() {
            constraints.prescribe(node, c, value).unwrap();
        }
    }
    let mut loads = vec![0.0; body.dofs()];
    add_body_force(&body, |x| body_force(x, material), &mut loads);
    let u = equilibrium(&body, &constraints, &loads, Solver::Cholesky)
        .unwrap()
        .displacement;

    let abscissa = 0.6f64.sqrt();
    let rule = [
        (-abscissa, 5.0 / 9.0),
        (0.0, 8.0 / 9.0),
        (abscissa, 5.0 / 9.0),
    ];
    let (mut l2, mut energy) = (0.0, 0.0);
    for cell in 0..body.mesh().cells.len() {
        let (corners, local) = (body.corners(cell), body.gather(cell, &u));
        for (a, wa) in rule {
            for (b, wb) in rule {
                for (c, wc) in rule {
                    let xi = [a, b, c];
                    let shape = hex8::shape_functions(xi);
                    let at = |i: usize| (0..8).map(|k| shape[k] * corners[k][i]).sum::<f64>();
                    let x = [at(0), at(1), at(2)];
                    let weight = wa * wb * wc * Jacobian::at(&corners, xi).determinant;
                    let exact = displacement(x);
                    for i in 0..3 {
                        let found: f64 = (0..8).map(|k| shape[k] * local[3 * k + i]).sum();
                        l2 += weight * (found - exact[i]).powi(2);
                    }
                    let found = strain_at(&body, cell, &u, xi);
                    let exact = strain(x);
                    let difference = std::array::from_fn(|i| found[i] - exact[i]);
                    let stress = material.stress(difference);
                    energy += weight * (0..6).map(|i| difference[i] * stress[i]).sum::<f64>();
                }
            }
        }
    }
    [l2.sqrt(), energy.sqrt()]
}

#[test]
fn manufactured_solution_converges_with_slope_2_in_l2_and_1_in_energy() {
    let sizes = [6, 8, 11, 16];
    let h = sizes.map(|n| 1.0 / n as f64);
    for kind in [ElementKind::Hex8, ElementKind::Hex8Incompatible] {
        let errors = sizes.map(|n| errors(n, kind));
        let l2 = fitted_slope(&h, &errors.map(|e| e[0]));
        let energy = fitted_slope(&h, &errors.map(|e| e[1]));
        println!("{kind:?}: slopes {l2:.3} in L2, {energy:.3} in energy; errors {errors:?}");
        assert!((l2 - 2.0).abs() < 0.1, "{kind:?}: {l2}");
        assert!((energy - 1.0).abs() < 0.1, "{kind:?}: {energy}");
    }
}
