//! Stress under the contact against that of elliptic Hertz contacts.

use kufe_contact::{ElasticRunner, Options, centre_line, hertz, runner_loads, solve};
use kufe_fem::von_mises;
use kufe_mesh::Paraboloid;
use kufe_tests::contact::{ICE_NU, contact_modulus, on_half_space};
use kufe_tests::coverage::ErrorPair;
use kufe_tests::under_peak::{hertz_shear, hertz_stress, random_contacts};

/// Johnson, sections 3.4 (circle: 0.31 p0 at 0.48 a) and 4.1 (line: 0.30 p0 at 0.78 b), for a
/// Poisson's ratio of 0.3.
#[test]
fn integral_of_point_loads_gives_textbook_values_for_circle_and_line() {
    let circle = hertz_shear(1.0, 1.0, 0.3);
    assert!((circle.value - 0.310).abs() < 0.001 && (circle.depth - 0.48).abs() < 0.021);
    let line = hertz_shear(2000.0, 1.0, 0.3);
    assert!((line.value - 0.30).abs() < 0.002 && (line.depth - 0.78).abs() < 0.03);
}

#[test]
fn largest_shear_under_elliptic_contacts_within_two_percent_of_hertz() {
    for (rocker, section, p_max_tolerance) in [
        (1.0, 1.0, 0.01),
        (0.1, 0.005, 0.01),
        (30.0, 0.005, 0.01),
        (30.0, 0.005, 0.001),
    ] {
        let h = hertz(rocker, section, contact_modulus(), 1000.0).unwrap();
        let expected = hertz_shear(h.a, h.b, ICE_NU);
        let options = Options {
            p_max_tolerance,
            ..Options::default()
        };
        let problem = on_half_space(Paraboloid::new(rocker, section).unwrap(), 1000.0);
        let solution = solve(&problem, &options).unwrap();
        let line = centre_line(&solution).unwrap().unwrap();
        let found = line
            .largest_shear()
            .expect("a largest shear under the surface");
        let report = format!(
            "a/b {:.1}: {:.4} p0 at {:.4} b; Hertz {:.4} at {:.4}",
            h.a / h.b,
            found.value / h.p_max,
            found.depth / h.b,
            expected.value,
            expected.depth / h.b
        );
        assert!(
            (found.value / (expected.value * h.p_max) - 1.0).abs() < 0.02,
            "{report}"
        );
        assert!(
            (found.depth / expected.depth - 1.0).abs() < 0.06,
            "{report}"
        );
        // The vertical stress just under the surface is the pressure.
        let first = line.stress[0][2];
        let [_, _, exact] = hertz_stress(h.a, h.b, ICE_NU, line.depth[0]);
        assert!(
            (first / (exact * h.p_max) - 1.0).abs() < 0.03,
            "{first} {exact}"
        );
    }
}

/// The stated errors cover in at least 95 % of the contacts, with a median ratio of stated to actual
/// error below 10.
#[test]
fn stated_errors_of_largest_shear_and_depth_cover_in_95_percent_of_contacts() {
    let contacts = random_contacts(20261128, 20);
    for requested in [0.02, 0.005] {
        let errors: Vec<[ErrorPair; 2]> = contacts
            .iter()
            .map(|contact| contact.errors(requested).expect("a solution"))
            .collect();
        for quantity in [0, 1] {
            let of = || errors.iter().map(|pair| pair[quantity]);
            let covered = of().filter(|e| e.actual <= e.stated).count();
            assert!(
                100 * covered >= 95 * errors.len(),
                "{requested} {quantity}: {errors:?}"
            );
            let mut ratios: Vec<f64> = of().map(|e| e.stated / e.actual.max(1e-12)).collect();
            ratios.sort_by(f64::total_cmp);
            let median = ratios[ratios.len() / 2];
            assert!(median < 10.0, "{requested} {quantity}: {median}");
        }
        // The extrapolated value has about the accuracy requested for the peak.
        assert!(
            errors.iter().all(|pair| pair[0].actual < 1.5 * requested),
            "{errors:?}"
        );
    }
}

/// Both half-spaces carry the same pressure; the stresses in the steel runner depend on its own
/// Poisson's ratio.
#[test]
fn largest_von_mises_stress_of_an_elastic_runner_within_three_percent_of_hertz() {
    let (steel, ratio) = (210e9, 0.3);
    let hull = Paraboloid::new(0.5, 0.05).expect("a paraboloid");
    let mut problem = on_half_space(hull, 1000.0);
    problem.runner.elastic = Some(ElasticRunner::fixed_at_top(steel, ratio, f64::INFINITY));
    let solution = solve(&problem, &Options::default()).expect("a solution");
    let loads = runner_loads(&problem, &solution)
        .expect("a body")
        .expect("an elastic runner");
    let both = 1.0 / contact_modulus() + (1.0 - ratio * ratio) / steel;
    let exact = hertz(0.5, 0.05, 1.0 / both, 1000.0).unwrap();
    let at = |z: f64| {
        let [xx, yy, zz] = hertz_stress(exact.a, exact.b, ratio, z);
        exact.p_max * von_mises([xx, yy, zz, 0.0, 0.0, 0.0])
    };
    let depths = (10..=60).map(|i| 0.02 * exact.b * f64::from(i));
    let (depth, most) = depths
        .map(|z| (z, at(z)))
        .max_by(|p, q| p.1.total_cmp(&q.1))
        .expect("depths");
    println!(
        "{:.4e} at {:?}, expected {most:.4e} at {depth:.3e}",
        loads.von_mises, loads.at
    );
    assert!(
        (loads.von_mises / most - 1.0).abs() < 0.03,
        "{loads:?} {most}"
    );
    let [x, y, z] = loads.at;
    assert!(
        x.hypot(y) < 0.2 * exact.b && (z / depth - 1.0).abs() < 0.3,
        "{loads:?}"
    );
    assert!(loads.mounts.is_empty());
}
