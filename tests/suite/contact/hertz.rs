//! Paraboloids on a half-space against Hertz's closed form.

use kufe_contact::{ElasticRunner, Ice, Options, Problem, StiffnessForm, hertz, solve};
use kufe_fem::Material;
use kufe_mesh::Paraboloid;
use kufe_tests::contact::{ICE_E, contact_modulus, on_half_space};

/// The reference table's runner; an unbounded hull has no top.
const STEEL: ElasticRunner = ElasticRunner {
    mount: kufe_contact::Mount::Top,
    flank: None,
    solid: None,
    youngs_modulus: 210e9,
    poissons_ratio: 0.30,
    top: f64::INFINITY,
};

/// Rows of the reference table for one kind of runner: rocker and section radius [m], force [N],
/// half-axes a and b [m], peak [Pa], approach [m].
fn reference_rows(runner: &str) -> Vec<[f64; 7]> {
    include_str!("../../data/hertz.csv")
        .lines()
        .filter(|line| line.split(',').next() == Some(runner))
        .map(|line| {
            let numbers: Vec<f64> = line
                .split(',')
                .skip(1)
                .map(|n| n.parse().unwrap())
                .collect();
            numbers.try_into().unwrap()
        })
        .collect()
}

#[test]
fn closed_form_agrees_with_every_rigid_reference_row() {
    for [rocker, section, force, a, b, p_max, approach] in reference_rows("rigid") {
        let h = hertz(rocker, section, contact_modulus(), force).unwrap();
        for (value, expected) in [(h.a, a), (h.b, b), (h.p_max, p_max), (h.approach, approach)] {
            assert!(
                (value / expected - 1.0).abs() < 2e-6,
                "{value} against {expected}"
            );
        }
    }
}

/// At 0.5 % requested: peak within 0.5 %, half-axes within 1.5 %, area within 2 %, approach within
/// 1 %, force to 1e-8. The stated error covers the actual error in at least 95 % of the rows.
#[test]
fn rigid_runners_agree_with_every_reference_row() {
    let rows = reference_rows("rigid");
    assert_eq!(rows.len(), 32);
    let mut covered = 0;
    for [rocker, section, force, a, b, p_max, approach] in rows {
        let hull = Paraboloid::new(rocker, section).unwrap();
        let options = Options {
            p_max_tolerance: 0.005,
            ..Options::default()
        };
        let s = solve(&on_half_space(hull, force), &options).unwrap();
        let row = format!("rocker {rocker} section {section} force {force}");
        let off = |value: f64, expected: f64| (value / expected - 1.0).abs();
        assert!(off(s.p_max, p_max) < 0.005, "{row}: p_max {:.3e}", s.p_max);
        assert!(
            off(0.5 * s.length, a) < 0.015,
            "{row}: a {:.4e}",
            0.5 * s.length
        );
        assert!(
            off(0.5 * s.width, b) < 0.015,
            "{row}: b {:.4e}",
            0.5 * s.width
        );
        assert!(
            off(s.area, std::f64::consts::PI * a * b) < 0.02,
            "{row}: area {:.4e}",
            s.area
        );
        assert!(
            off(s.approach, approach) < 0.01,
            "{row}: approach {:.4e}",
            s.approach
        );
        assert!(off(s.fz, force) < 1e-8, "{row}: force {}", s.fz);
        assert!(
            s.kkt_residual < 1e-8,
            "{row}: residual {:.1e}",
            s.kkt_residual
        );
        covered += usize::from((s.p_max - p_max).abs() <= s.p_max_error);
    }
    assert!(
        covered >= 31,
        "the stated error covers the actual error in {covered} of 32 rows"
    );
}

/// Two meshes may agree on a rim by chance; the stated errors cover nevertheless.
#[test]
fn errors_of_extents_areas_and_mean_pressures_cover_at_every_aspect_ratio() {
    for ratio in [1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 50.0, 150.0] {
        for p_max_tolerance in [0.05, 0.005, 0.002] {
            let hull = Paraboloid::new(ratio, 1.0).unwrap();
            let options = Options {
                p_max_tolerance,
                ..Options::default()
            };
            let s = solve(&on_half_space(hull, 1000.0), &options).unwrap();
            let h = hertz(ratio, 1.0, contact_modulus(), 1000.0).unwrap();
            let area = std::f64::consts::PI * h.a * h.b;
            for (name, value, error, expected) in [
                ("length", s.length, s.length_error, 2.0 * h.a),
                ("width", s.width, s.width_error, 2.0 * h.b),
                ("area", s.area, s.area_error, area),
                ("mean pressure", s.p_mean, s.p_mean_error, 1000.0 / area),
            ] {
                assert!(
                    (value - expected).abs() <= error,
                    "{name} at {ratio}, {p_max_tolerance}: {value:.5e} ± {error:.1e}, Hertz {expected:.5e}"
                );
            }
        }
    }
}

/// At 2 % requested: peak within 0.6 %, area within 3 %, fewer than 100,000 unknowns. With locking,
/// 0.499 would require three million unknowns.
#[test]
fn poissons_ratios_up_to_0_4999_do_not_lock() {
    for ratio in [0.3, 0.45, 0.49, 0.499, 0.4999] {
        let (rocker, section, force) = (30.0, 0.005, 1000.0);
        let modulus = Material::new(ICE_E, ratio).unwrap().plane_strain_modulus();
        let h = hertz(rocker, section, modulus, force).unwrap();
        let problem = Problem {
            ice: Ice::half_space(ICE_E, ratio),
            ..on_half_space(Paraboloid::new(rocker, section).unwrap(), force)
        };
        let solved = |stiffness| {
            let options = Options {
                p_max_tolerance: 0.02,
                stiffness,
                ..Options::default()
            };
            solve(&problem, &options).unwrap()
        };
        let s = solved(StiffnessForm::MatrixFree);
        let off = |value: f64, expected: f64| (value / expected - 1.0).abs();
        println!(
            "{ratio}: peak off by {:.2e}, stated {:.2e}, {} unknowns, {} iterations",
            off(s.p_max, h.p_max),
            s.p_max_error / s.p_max,
            s.dofs,
            s.iterations
        );
        assert!(s.dofs < 100_000, "{ratio}: {} unknowns", s.dofs);
        assert!(off(s.p_max, h.p_max) < 0.006, "{ratio}: {:.4e}", s.p_max);
        assert!((s.p_max - h.p_max).abs() <= s.p_max_error, "{ratio}");
        let area = std::f64::consts::PI * h.a * h.b;
        assert!(off(s.area, area) < 0.03, "{ratio}: area {:.4e}", s.area);
        let stored = solved(StiffnessForm::Assembled);
        assert!(
            off(stored.p_max, s.p_max) < 1e-6,
            "{ratio}: {:.6e}",
            stored.p_max
        );
    }
}

/// Both bodies deform: the contact modulus is that of ice and steel in series.
#[test]
fn elastic_runners_agree_with_every_reference_row() {
    let rows = reference_rows("steel");
    assert_eq!(rows.len(), 32);
    for [rocker, section, force, a, b, p_max, approach] in rows {
        let hull = Paraboloid::new(rocker, section).unwrap();
        let mut problem = on_half_space(hull, force);
        problem.runner.elastic = Some(STEEL);
        let options = Options {
            p_max_tolerance: 0.005,
            ..Options::default()
        };
        let s = solve(&problem, &options).unwrap();
        let row = format!("rocker {rocker} section {section} force {force}");
        let off = |value: f64, expected: f64| (value / expected - 1.0).abs();
        assert!(off(s.p_max, p_max) < 0.007, "{row}: p_max {:.4e}", s.p_max);
        assert!(off(0.5 * s.length, a) < 0.015, "{row}: {:.4e}", s.length);
        assert!(off(0.5 * s.width, b) < 0.015, "{row}: {:.4e}", s.width);
        assert!(
            off(s.approach, approach) < 0.01,
            "{row}: {:.4e}",
            s.approach
        );
        assert!(off(s.fz, force) < 1e-8, "{row}: force {}", s.fz);
    }
}

#[test]
fn iterations_do_not_grow_with_refinement_or_aspect_ratio() {
    for (rocker, section) in [(0.01, 0.01), (0.1, 0.005), (30.0, 0.005), (300.0, 0.002)] {
        for cells in [4, 8, 16] {
            let hull = Paraboloid::new(rocker, section).unwrap();
            let options = Options {
                cells: Some(cells),
                ..Options::default()
            };
            let s = solve(&on_half_space(hull, 1000.0), &options).unwrap();
            assert!(
                s.iterations <= 30,
                "rocker {rocker} cells {cells}: {} iterations",
                s.iterations
            );
        }
    }
}
