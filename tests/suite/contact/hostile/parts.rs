//! Closed forms, grooves, anchors and meshed runners with invalid numbers. The result is an error or
//! finite, without panic.

use std::sync::Arc;

use super::NUMBERS;
use kufe_contact::{
    ElasticRunner, Error, GrooveProfile, Ice, Load, Options, Problem, Runner, RunnerSolid, Tilt,
    VerifiedBem, hertz, slide, solve,
};
use kufe_mesh::{HexMesh, Paraboloid};
use kufe_tests::contact::{ICE_E, ICE_NU};
use kufe_tests::meshes::block;

fn quick() -> Options {
    Options {
        p_max_tolerance: 0.1,
        max_dofs: 4_000,
        ..Options::default()
    }
}

fn problem(hardness: Option<f64>) -> Problem {
    let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005).unwrap()));
    let ice = Ice {
        hardness,
        ..Ice::half_space(ICE_E, ICE_NU)
    };
    Problem::new(runner, ice, Load::central(1000.0, Tilt::Free))
}

#[test]
fn invalid_grooves_are_rejected_and_extreme_ones_give_finite_results() {
    let check = |y: Vec<f64>, depth: Vec<f64>| {
        let Ok(groove) = GrooveProfile::new(y, depth) else {
            return;
        };
        let values = [groove.area(), groove.deepest(), groove.at(0.1e-3)];
        match slide(&problem(Some(20e6)), Some(&groove), &quick()) {
            Ok(slid) => assert!(
                slid.contact.p_max.is_finite() && slid.contact.area > 0.0,
                "{groove:?}"
            ),
            Err(error) => assert!(!error.to_string().is_empty(), "{values:?}"),
        }
    };
    for number in NUMBERS {
        check(vec![-0.001, 0.0, 0.001], vec![0.0, number, 0.0]);
        check(vec![-0.001, 0.0, 0.001], vec![number; 3]);
        check(vec![-0.001, 0.0, number], vec![0.0, 1e-6, 0.0]);
        check(vec![-number, 0.0, number], vec![0.0, 1e-6, 0.0]);
        check(vec![number, 0.0, 0.001], vec![0.0, 1e-6, 0.0]);
    }
    check(Vec::new(), Vec::new());
    check(vec![0.0, 1.0], vec![0.0]);
}

#[test]
fn anchors_with_invalid_tolerances_or_values_are_rejected() {
    let anchor = problem(None);
    let solved = solve(&anchor, &Options::default()).unwrap();
    let pairs = [(anchor.clone(), solved.clone())];
    assert!(VerifiedBem::at(&pairs, 0.01).is_some());
    assert!(VerifiedBem::at(&[], 0.01).is_none());
    for number in NUMBERS.into_iter().filter(|n| n.is_nan() || *n < 0.01) {
        assert!(VerifiedBem::at(&pairs, number).is_none(), "{number}");
    }
    for number in NUMBERS {
        for quantity in 0..4 {
            let mut changed = solved.clone();
            *[
                &mut changed.p_max,
                &mut changed.p_max_error,
                &mut changed.approach,
                &mut changed.area,
            ][quantity] = number;
            // A large stated error covers the difference of the methods and is accepted; the other
            // values are not.
            let trusted = VerifiedBem::at(&[(anchor.clone(), changed)], 0.01);
            assert!(trusted.is_none() || quantity == 1, "{quantity} {number}");
            if let Some(anchored) = trusted {
                assert!(anchored.apart().is_finite(), "{quantity} {number}");
            }
        }
        let mut other = anchor.clone();
        other.load = Load::central(number, Tilt::Free);
        if let Some(found) = VerifiedBem::at(&pairs, 0.01).unwrap().answer(&other) {
            assert!(found.p_max.is_finite() && found.p_max > 0.0, "{number}");
        }
    }
}

fn solid(mesh: HexMesh, young: f64, poisson: f64, fixed: f64) -> Result<RunnerSolid, Error> {
    RunnerSolid::new(mesh, young, poisson, |p| p[2] > fixed)
}

#[test]
fn invalid_runner_meshes_are_rejected() {
    let mesh = || block([3, 2, 2], [0.1; 3]);
    assert!(solid(mesh(), 210e9, 0.3, 0.09).is_ok());
    let pressed = |solid: RunnerSolid| {
        let elastic = ElasticRunner {
            solid: Some(Arc::new(solid)),
            ..ElasticRunner::fixed_at_top(210e9, 0.3, 0.0)
        };
        let mut problem = problem(None);
        problem.runner.elastic = Some(elastic);
        problem.load = Load::central(1.0, Tilt::Free);
        let coarse = Options {
            cells: Some(3),
            ..quick()
        };
        match solve(&problem, &coarse) {
            Ok(s) => assert!(s.p_max.is_finite() && s.area > 0.0),
            Err(Error::AccuracyNotReached { best, .. }) => assert!(best.p_max.is_finite()),
            Err(_) => {}
        }
    };
    for number in NUMBERS {
        if let Ok(solid) = solid(mesh(), number, 0.3, 0.09) {
            pressed(solid);
        }
        let made = solid(mesh(), 210e9, number, 0.09);
        assert!(made.is_err() || number.abs() < 0.5, "{number}");
        for axis in 0..3 {
            let mut odd = mesh();
            odd.points[5][axis] = number;
            let made = solid(odd, 210e9, 0.3, 0.09);
            assert!(made.is_err() || number.is_finite(), "{axis} {number}");
        }
    }
    // A wedge is a hexahedron with a repeated node.
    let mut wedge = mesh();
    wedge.cells[0][3] = wedge.cells[0][2];
    if let Ok(solid) = solid(wedge, 210e9, 0.3, 0.09) {
        pressed(solid);
    }
    let refused = |change: fn(&mut HexMesh), what: &str| {
        let mut odd = mesh();
        change(&mut odd);
        assert!(solid(odd, 210e9, 0.3, 0.09).is_err(), "{what}");
    };
    // A fixed edge allows rotation about it.
    let hinged = RunnerSolid::new(mesh(), 210e9, 0.3, |p| p[2] > 0.09 && p[0] < 0.01);
    let reported = hinged.unwrap_err().to_string();
    assert!(reported.contains("hold every rigid motion"), "{reported}");
    refused(|m| m.cells[0][3] = usize::MAX, "index out of range");
    refused(|m| m.cells.clear(), "no cells");
    refused(
        |m| {
            m.points.clear();
            m.cells.clear();
        },
        "no points and no cells",
    );
    refused(|m| m.points.iter_mut().for_each(|p| p[2] = 0.0), "flat");
}

#[test]
fn hertz_with_invalid_numbers_returns_an_error_or_finite_values() {
    let valid = [30.0, 0.005, 10.1e9, 1000.0];
    for place in 0..4 {
        for number in NUMBERS {
            let mut n = valid;
            n[place] = number;
            if let Ok(h) = hertz(n[0], n[1], n[2], n[3]) {
                let values = [h.a, h.b, h.p_max, h.approach];
                assert!(
                    values.iter().all(|f| *f > 0.0 && f.is_finite()),
                    "{n:?}: {h:?}"
                );
            }
        }
    }
    assert!(hertz(0.005, 30.0, 10.1e9, 1000.0).is_err());
}
