//! The closed forms against finite differences, equilibrium and one another.

use std::f64::consts::PI;

use kufe_fem::{Material, boussinesq};
use kufe_tests::fem::closed_form::{Beam, ThickCylinder, boussinesq_stress};

fn steel() -> Beam {
    Beam {
        length: 0.6,
        width: 0.02,
        height: 0.008,
        material: Material::new(210e9, 0.3).unwrap(),
    }
}

#[test]
fn shear_deflection_of_a_slender_cantilever_is_1_36e_4_of_bending() {
    let beam = steel();
    let bending = 10.0 * 0.6f64.powi(3) / (3.0 * beam.bending_stiffness());
    let ratio = beam.cantilever_tip_deflection(10.0) / bending;
    // 3 E I / (kappa G A L^2) = E h^2 / (4 kappa G L^2) = 1.36e-4.
    assert!((ratio - 1.0 - 1.36e-4).abs() < 1e-6, "{ratio}");
}

fn ice() -> Material {
    Material::new(9.0e9, 0.33).unwrap()
}

fn first(u: &dyn Fn([f64; 3]) -> [f64; 3], p: [f64; 3], a: usize, h: f64) -> [f64; 3] {
    let at = |s: f64| {
        let mut q = p;
        q[a] += s * h;
        u(q)
    };
    let (m2, m1, p1, p2) = (at(-2.0), at(-1.0), at(1.0), at(2.0));
    std::array::from_fn(|c| (m2[c] - 8.0 * m1[c] + 8.0 * p1[c] - p2[c]) / (12.0 * h))
}

fn differentiated_stress(p: [f64; 3], m: Material) -> [f64; 6] {
    let u = |q| boussinesq(q, 1.0, m);
    let g: [[f64; 3]; 3] = std::array::from_fn(|a| first(&u, p, a, 1e-3));
    m.stress([
        g[0][0],
        g[1][1],
        g[2][2],
        g[1][2] + g[2][1],
        g[0][2] + g[2][0],
        g[0][1] + g[1][0],
    ])
}

#[test]
fn stress_is_the_derivative_of_the_displacement_by_hookes_law() {
    for nu in [0.0, 0.33, 0.49] {
        let m = Material::new(9.0e9, nu).unwrap();
        for p in [[0.7, -0.4, -0.9], [0.0, 0.0, -0.6], [-1.1, 0.6, -0.3]] {
            let (exact, differences) = (boussinesq_stress(p, 1.0, m), differentiated_stress(p, m));
            let size = exact.iter().fold(0.0f64, |s, v| s.max(v.abs()));
            for c in 0..6 {
                assert!(
                    (exact[c] - differences[c]).abs() < 1e-8 * size,
                    "{nu} {p:?} {c}"
                );
            }
        }
    }
}

#[test]
fn surface_is_free_of_traction_away_from_the_point_load() {
    let m = ice();
    for p in [[0.5, 0.2, 0.0], [-1.0, 0.7, 0.0]] {
        let s = boussinesq_stress(p, 1.0, m);
        assert_eq!([s[2], s[3], s[4]], [0.0; 3]);
        // The displacements are smooth across z = 0 away from the origin.
        let d = differentiated_stress(p, m);
        for c in [2, 3, 4] {
            assert!(d[c].abs() < 1e-9 * s[0].abs().max(s[1].abs()), "{d:?}");
        }
    }
}

#[test]
fn every_horizontal_plane_carries_the_whole_load() {
    // Integral of -s_zz over the plane at depth d with r = d tan t, midpoint rule in t.
    let n = 20_000;
    let depth = 0.7;
    let total: f64 = (0..n)
        .map(|i| {
            let t = (i as f64 + 0.5) / n as f64 * PI / 2.0;
            let r = depth * t.tan();
            let s = boussinesq_stress([r, 0.0, -depth], 5.0, ice());
            -s[2] * 2.0 * PI * r * depth / t.cos().powi(2) * (PI / 2.0 / n as f64)
        })
        .sum();
    assert!((total - 5.0).abs() < 1e-6, "{total}");
}

#[test]
fn lame_stresses_meet_wall_pressures_equilibrium_and_hookes_law() {
    let c = ThickCylinder {
        inner_radius: 1.0,
        outer_radius: 2.5,
        inner_pressure: 7.0,
        outer_pressure: 2.0,
    };
    let m = Material::new(100.0, 0.3).unwrap();
    assert!((c.stress(1.0, m)[0] + 7.0).abs() < 1e-14);
    assert!((c.stress(2.5, m)[0] + 2.0).abs() < 1e-14);
    let (r, h) = (1.7, 1e-4);
    let [radial, hoop, axial] = c.stress(r, m);
    let slope = (c.stress(r + h, m)[0] - c.stress(r - h, m)[0]) / (2.0 * h);
    assert!((slope + (radial - hoop) / r).abs() < 1e-6);
    // Hooke's law from the displacement: strains u', u / r, 0.
    let du = (c.displacement(r + h, m) - c.displacement(r - h, m)) / (2.0 * h);
    let stress = m.stress([du, c.displacement(r, m) / r, 0.0, 0.0, 0.0, 0.0]);
    for (found, expected) in stress.iter().zip([radial, hoop, axial]) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}
