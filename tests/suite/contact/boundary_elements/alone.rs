//! Boundary elements against closed forms, Hankel transforms and finite elements.

use kufe_contact::{
    CheckUnavailable, Foundation, Ice, Load, Options, Problem, Tilt, boundary_elements,
    boundary_elements_to, hertz, solve,
};
use kufe_mesh::{BobRunner, Paraboloid};
use kufe_tests::contact::{Formula, contact_modulus, on_half_space};
use kufe_tests::coverage::{ErrorPair, rows};

#[test]
fn peaks_and_approaches_within_0_2_percent_of_hertz_at_aspect_ratios_of_1_to_900() {
    // Patches 1 to 900 times as long as wide.
    for rocker in [0.005, 0.02, 0.1, 0.5, 3.0, 30.0, 150.0, 600.0] {
        let hull = Paraboloid::new(rocker, 0.005).unwrap();
        let found = boundary_elements(&on_half_space(hull, 1000.0)).unwrap();
        let exact = hertz(rocker, 0.005, contact_modulus(), 1000.0).unwrap();
        let off = [
            found.p_max / exact.p_max - 1.0,
            found.approach / exact.approach - 1.0,
        ];
        assert!(off.iter().all(|off| off.abs() < 2e-3), "{rocker}: {off:?}");
    }
}

#[test]
fn requested_error_of_0_1_percent_is_stated_and_covers_hertz() {
    for (rocker, fz) in [
        (15.0, 250.0),
        (30.0, 1000.0),
        (90.0, 4000.0),
        (250.0, 700.0),
    ] {
        let problem = on_half_space(Paraboloid::new(rocker, 0.005).unwrap(), fz);
        let first = boundary_elements(&problem).unwrap();
        let found = boundary_elements_to(&problem, 1e-3).unwrap();
        let exact = hertz(rocker, 0.005, contact_modulus(), fz).unwrap();
        let off = (found.p_max - exact.p_max).abs();
        assert!(off <= found.p_max_error, "{rocker}: {off} {found:?}");
        assert!(
            found.p_max_error <= 1e-3 * found.p_max,
            "{rocker}: {found:?}"
        );
        assert!(
            found.p_max_error <= first.p_max_error,
            "{rocker}: {first:?}"
        );
    }
}

/// The stated error is three times the range over three grids.
#[test]
fn stated_errors_cover_in_95_percent_of_random_contacts() {
    let (mut covered, mut count, mut reported) = (0, 0, Vec::new());
    for row in rows() {
        let found = match boundary_elements(&row.problem()) {
            Ok(found) => found,
            Err(CheckUnavailable::NarrowPeak) => continue,
            Err(error) => panic!("{}: {error}", row.text),
        };
        let quantities = [
            (0, found.p_max, found.p_max_error),
            (1, found.area, found.area_error),
            (2, found.approach, found.approach_error),
        ];
        for (quantity, value, error) in quantities {
            let Some(errors) = row.errors(quantity, value, error) else {
                continue;
            };
            count += 1;
            if row.is_covered(quantity, errors) {
                covered += 1
            } else {
                reported.push(format!("{}: {errors:?}", row.text))
            }
            let ErrorPair { actual, stated } = errors;
            // A pressure ridge narrower than the cells has a large stated error.
            let ridge = row.text.starts_with("worn flat");
            let [largest_actual, largest_stated] = match quantity {
                1 => [0.1, 0.4],
                _ if ridge => [0.25, 0.3],
                _ => [0.03, 0.04],
            };
            assert!(
                actual < largest_actual && stated < largest_stated,
                "{}: {errors:?}",
                row.text
            );
        }
    }
    assert!(count >= 560, "{count} values");
    assert!(
        100 * covered >= 95 * count,
        "{covered} of {count}: {reported:?}"
    );
}

#[test]
fn prescribed_approach_gives_the_approach_and_peak_of_the_prescribed_load() {
    let by_load = boundary_elements(&on_half_space(
        Paraboloid::new(30.0, 0.005).unwrap(),
        1000.0,
    ));
    let by_load = by_load.unwrap();
    let fixed = Problem {
        load: Load::Approach {
            approach: by_load.approach,
            pitch: 0.0,
            roll: 0.0,
        },
        ..on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1.0)
    };
    let found = boundary_elements(&fixed).unwrap();
    let difference = (found.approach / by_load.approach - 1.0).abs();
    assert!(difference < 1e-3, "{found:?} {by_load:?}");
    assert!(
        (found.p_max / by_load.p_max - 1.0).abs() < 2e-3,
        "{found:?}"
    );
}

/// A runner of finite length on a layer under an offset load, which has no closed form.
#[test]
fn finite_and_boundary_elements_agree_within_both_stated_errors() {
    for (offset_x, offset_y, fz) in [(0.0, 0.0, 1000.0), (0.03, 0.0, 500.0), (0.02, 2e-4, 2000.0)] {
        let problem = Problem {
            ice: Ice {
                foundation: Foundation::RigidBed { thickness: 0.01 },
                ..Ice::half_space(9e9, 0.33)
            },
            load: Load::Force {
                fz,
                offset_x,
                offset_y,
                tilt: Tilt::Free,
            },
            ..on_half_space(BobRunner::default().swept().unwrap(), fz)
        };
        let second = boundary_elements(&problem).unwrap();
        let first = solve(&problem, &Options::default()).unwrap();
        let apart = [
            (first.p_max - second.p_max).abs() / (first.p_max_error + second.p_max_error),
            (first.approach - second.approach).abs()
                / (first.approach_error + second.approach_error),
        ];
        assert!(
            apart.iter().all(|apart| *apart < 1.0),
            "{apart:?} {second:?}"
        );
        assert!(second.p_max_error < 0.02 * second.p_max, "{second:?}");
    }
}

#[test]
fn narrow_peaks_and_elastic_runners_return_check_unavailable() {
    // Contact at the two ends, with peaks a few millimetres long.
    let ends = Problem {
        track_curvature: 0.04,
        ..on_half_space(BobRunner::default().swept().unwrap(), 1000.0)
    };
    assert_eq!(boundary_elements(&ends), Err(CheckUnavailable::NarrowPeak));
    let mut elastic = on_half_space(BobRunner::default().swept().unwrap(), 1000.0);
    let steel = kufe_contact::ElasticRunner::fixed_at_top(210e9, 0.3, 0.03);
    elastic.runner.elastic = Some(steel);
    assert_eq!(
        boundary_elements(&elastic),
        Err(CheckUnavailable::ElasticRunner)
    );
}

#[test]
fn second_patch_outside_the_grid_returns_elsewhere() {
    // The approach of the runner is 12.5 µm. A bump at x = 0.4 m is above or below that depth.
    let with_bump = |low: f64| {
        let hull = Formula {
            height: move |x: f64, y: f64| {
                let bump = low + (x - 0.4).powi(2) / 2.0;
                (x * x / 60.0).min(bump) + y * y / 0.01
            },
            extent: [-0.5, 0.5, -0.005, 0.005],
            symmetric: [false, true],
        };
        Problem {
            load: Load::central(1000.0, Tilt::LEVEL),
            ..on_half_space(hull, 1000.0)
        }
    };
    let apart = boundary_elements(&with_bump(16e-6)).unwrap();
    let truth = hertz(30.0, 0.005, contact_modulus(), 1000.0).unwrap().p_max;
    assert!((apart.p_max - truth).abs() < apart.p_max_error);
    assert_eq!(
        boundary_elements(&with_bump(8e-6)),
        Err(CheckUnavailable::Elsewhere)
    );
}

/// At a distance of 0.15 m from a load of 1 kN a half-space is displaced by 0.2 µm, a layer of 2 mm
/// on a rigid bed by zero.
#[test]
fn second_patch_on_thin_ice_returns_elsewhere_and_on_a_half_space_does_not_touch() {
    let with_bump = |low: f64, foundation: Foundation| {
        let hull = Formula {
            height: move |x: f64, y: f64| {
                let bump = low + (x - 0.15).powi(2) / 20.0;
                (x * x / 60.0).min(bump) + y * y / 0.01
            },
            extent: [-0.5, 0.5, -0.005, 0.005],
            symmetric: [false, true],
        };
        let problem = Problem {
            ice: Ice {
                foundation,
                ..Ice::half_space(9e9, 0.33)
            },
            load: Load::central(1000.0, Tilt::LEVEL),
            ..on_half_space(hull, 1000.0)
        };
        boundary_elements(&problem)
    };
    let thin = Foundation::RigidBed { thickness: 2e-3 };
    for (foundation, expected) in [
        (Foundation::HalfSpace, None),
        (thin, Some(CheckUnavailable::Elsewhere)),
    ] {
        let approach = with_bump(1e-3, foundation).unwrap().approach;
        let found = with_bump(approach - 1.5e-7, foundation);
        assert_eq!(found.err(), expected, "{foundation:?}");
    }
}

#[test]
fn approach_agrees_with_finite_elements_where_most_of_the_patch_yields() {
    let hardness = 25e6;
    let problem = Problem {
        ice: Ice {
            foundation: Foundation::RigidBed { thickness: 0.05 },
            hardness: Some(hardness),
            ..Ice::half_space(9e9, 0.33)
        },
        ..on_half_space(BobRunner::default().swept().unwrap(), 1000.0)
    };
    let second = boundary_elements(&problem).unwrap();
    let first = solve(&problem, &Options::default()).unwrap();
    let apart = (first.approach - second.approach).abs();
    assert!(
        apart < first.approach_error + second.approach_error,
        "{second:?} {}",
        first.approach
    );
    // The comparison above requires a small stated error.
    assert!(second.approach_error < 0.1 * second.approach, "{second:?}");
    assert_eq!((first.p_max, second.p_max), (hardness, hardness));
}
