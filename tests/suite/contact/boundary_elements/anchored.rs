//! Boundary elements verified by finite elements at anchor points, against closed forms and finer
//! finite elements between them.

use kufe_contact::{
    Foundation, Ice, Load, Options, Problem, Solution, Tilt, VerifiedBem, hertz, solve,
};
use kufe_mesh::{BobRunner, Paraboloid};
use kufe_tests::contact::{contact_modulus, on_half_space};

const TOLERANCE: f64 = 0.005;

fn to(p_max_tolerance: f64) -> Options {
    Options {
        p_max_tolerance,
        ..Options::default()
    }
}

fn pressed(problems: Vec<Problem>) -> Vec<(Problem, Solution)> {
    let solved = |problem: Problem| {
        let solution = solve(&problem, &to(TOLERANCE)).unwrap();
        (problem, solution)
    };
    problems.into_iter().map(solved).collect()
}

fn paraboloid(rocker: f64, fz: f64) -> Problem {
    on_half_space(Paraboloid::new(rocker, 0.005).unwrap(), fz)
}

/// A runner of finite length on a layer of 20 mm.
fn bob(track_curvature: f64, fz: f64) -> Problem {
    Problem {
        track_curvature,
        ice: Ice {
            foundation: Foundation::RigidBed { thickness: 0.02 },
            ..Ice::half_space(9e9, 0.33)
        },
        ..on_half_space(BobRunner::default().swept().unwrap(), fz)
    }
}

#[test]
fn stated_errors_cover_hertz_between_the_anchors() {
    let corners = [
        (15.0, 250.0),
        (15.0, 4000.0),
        (250.0, 250.0),
        (250.0, 4000.0),
    ];
    let anchors = pressed(corners.map(|(r, fz)| paraboloid(r, fz)).into());
    let anchored = VerifiedBem::at(&anchors, TOLERANCE).expect("two methods that agree");
    assert!(anchored.apart() > 0.0 && anchored.apart() < 0.5 * TOLERANCE);
    let mut answered = 0;
    for (rocker, fz) in [
        (20.0, 300.0),
        (37.0, 3900.0),
        (61.0, 800.0),
        (110.0, 2222.0),
        (180.0, 500.0),
        (240.0, 1e3),
    ] {
        let Some(found) = anchored.answer(&paraboloid(rocker, fz)) else {
            continue;
        };
        answered += 1;
        let exact = hertz(rocker, 0.005, contact_modulus(), fz).unwrap();
        let area = std::f64::consts::PI * exact.a * exact.b;
        for (value, truth, error) in [
            (found.p_max, exact.p_max, found.p_max_error),
            (found.approach, exact.approach, found.approach_error),
            (found.area, area, found.area_error),
            (found.length, 2.0 * exact.a, found.length_error),
            (found.width, 2.0 * exact.b, found.width_error),
        ] {
            assert!(
                (value - truth).abs() <= error,
                "{rocker} m {fz} N: {value} {truth} {error}"
            );
            assert!(error < 0.08 * truth, "{rocker} m {fz} N: {value} {error}");
        }
        assert!(found.p_max_error <= TOLERANCE * found.p_max);
        assert!(found.p_max_error >= anchored.apart() * found.p_max);
    }
    assert!(answered >= 4, "{answered} of 6");
}

#[test]
fn peaks_of_a_finite_runner_on_a_layer_agree_with_finer_finite_elements() {
    let corners = [
        (-0.02, 400.0),
        (-0.02, 3000.0),
        (0.02, 400.0),
        (0.02, 3000.0),
    ];
    let anchors = pressed(corners.map(|(k, fz)| bob(k, fz)).into());
    let anchored = VerifiedBem::at(&anchors, TOLERANCE).expect("two methods that agree");
    let mut answered = 0;
    for (curvature, fz) in [(0.0, 1000.0), (0.012, 600.0), (-0.007, 2500.0)] {
        let problem = bob(curvature, fz);
        let Some(found) = anchored.answer(&problem) else {
            continue;
        };
        answered += 1;
        let finer = solve(&problem, &to(0.001)).unwrap();
        let apart = (found.p_max - finer.p_max).abs();
        assert!(
            apart <= found.p_max_error + finer.p_max_error,
            "{curvature}: {found:?} {}",
            finer.p_max
        );
    }
    assert!(answered >= 2, "{answered} of 3");
}

#[test]
fn anchors_are_rejected_where_the_methods_disagree_or_one_does_not_apply() {
    let anchors = pressed(vec![paraboloid(30.0, 1000.0)]);
    assert!(VerifiedBem::at(&anchors, TOLERANCE).is_some());
    assert_eq!(VerifiedBem::at(&[], TOLERANCE), None);
    let [(problem, solution)] = &anchors[..] else {
        panic!("one anchor");
    };
    let peak = Solution {
        p_max: 1.02 * solution.p_max,
        ..solution.clone()
    };
    let approach = Solution {
        approach: 0.95 * solution.approach,
        ..solution.clone()
    };
    let area = Solution {
        area: 1.2 * solution.area,
        ..solution.clone()
    };
    let width = Solution {
        width: 0.9 * solution.width,
        ..solution.clone()
    };
    for changed in [peak, approach, area, width] {
        assert_eq!(
            VerifiedBem::at(&[(problem.clone(), changed)], TOLERANCE),
            None
        );
    }
    // Yielding ice; contact at the two ends; a tolerance below the difference of the methods.
    let mut soft = problem.clone();
    soft.ice.hardness = Some(60e6);
    let off_the_middle = Problem {
        load: Load::Force {
            fz: 1000.0,
            offset_x: 0.03,
            offset_y: 0.0,
            tilt: Tilt::Free,
        },
        ..bob(0.04, 1000.0)
    };
    for other in [soft, off_the_middle] {
        let pairs = [anchors[0].clone(), (other, solution.clone())];
        assert_eq!(VerifiedBem::at(&pairs, TOLERANCE), None);
    }
    assert_eq!(VerifiedBem::at(&anchors, 1e-6), None);
    // Peaks that the grid does not resolve have no result between anchors either.
    let anchored = VerifiedBem::at(&anchors, TOLERANCE).unwrap();
    assert_eq!(anchored.answer(&bob(0.04, 1000.0)), None);
}
