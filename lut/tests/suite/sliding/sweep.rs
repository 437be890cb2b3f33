//! Sweeps over speed and temperature.

use crate::tables::slid;
use kufe_lut::{
    Layered, Mode, Next, Origin, Plan, Point, Quantity, Spacing, Store, next_batch, solve_missing,
    sweep,
};
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

fn range(from: f64, to: f64) -> Spacing {
    Spacing::Range { from, to }
}

/// Given forces and curvatures, ranges of speed and temperature.
fn plan() -> Plan {
    let fz = vec![300.0, 800.0, 2000.0];
    let mut plan = Plan::new(Spacing::Values(fz), Spacing::Values(vec![0.0, 0.01, 0.02]));
    plan.speed = Some(range(2.0, 40.0));
    plan.ice_c = Some(range(-12.0, -1.0));
    plan.interpolation = 0.005;
    plan.checks = 60;
    plan
}

#[test]
fn ranges_of_speed_and_temperature_are_refined_until_mu_is_as_asked_where_nobody_looked() {
    let plan = plan();
    let swept = sweep(&plan, |point| Ok::<_, Infallible>(slid(point))).unwrap();
    assert!(swept.shortfall.is_none(), "{:?}", swept.shortfall);
    let axes = swept.table.axes();
    let (speeds, temperatures) = (axes.speed().unwrap(), axes.ice_c().unwrap());
    assert!(speeds.len() > 5 && temperatures.len() >= 5);
    for mode in Mode::ALL {
        let mu = Layered::new(&swept.table, Quantity::Mu, mode, None).unwrap();
        // On the given forces and curvatures, whose spacing is measured and not mended.
        for n in 0..500 {
            let t = |step: f64| (0.31 + f64::from(n) * step).fract();
            let point = Point {
                fz: 800.0,
                curvature: 0.01,
                rocker_radius: None,
                speed: Some(2.0 * 20f64.powf(t(0.7548776662466927))),
                ice_c: Some(-12.0 + 11.0 * t(0.5698402909980532)),
            };
            let truth = slid(&point).sliding.unwrap().mu;
            let (v, ice) = (point.speed.unwrap(), point.ice_c.unwrap());
            let error = (mu.at(point.fz, point.curvature, v, ice).value / truth - 1.0).abs();
            assert!(error <= plan.interpolation, "{mode:?} {point}: {error}");
        }
    }
}

#[test]
fn points_that_differ_in_speed_alone_are_solved_together_and_resume_one_by_one() {
    let mut plan = plan();
    plan.speed = Some(Spacing::Values(vec![3.0, 10.0, 30.0]));
    plan.ice_c = Some(Spacing::Values(vec![-9.0, -2.0]));
    plan.checks = 5;
    let folder = tempfile::tempdir().unwrap();
    let origin = Origin {
        version: "1".into(),
        case_sha256: "2".into(),
    };
    let store = Store::open(folder.path(), origin).unwrap();
    let Next::Points { points, .. } = next_batch(&plan, &store).unwrap() else {
        panic!("nothing is solved yet");
    };
    assert_eq!(points.len(), 3 * 3 * 3 * 2 + 5);
    let groups = AtomicUsize::new(0);
    let solve = |group: &[Point]| {
        groups.fetch_add(1, Ordering::Relaxed);
        let first = Point {
            speed: None,
            ..group[0]
        };
        for point in group {
            let alike = Point {
                speed: None,
                ..*point
            };
            assert_eq!(alike, first);
        }
        group.iter().map(|p| Ok::<_, Infallible>(slid(p))).collect()
    };
    // A process that died after seven points.
    solve_missing(&store, &points[..7], solve).unwrap();
    groups.store(0, Ordering::Relaxed);
    let done = solve_missing(&store, &points, solve).unwrap();
    assert_eq!((done.kept, done.solved), (7, 3 * 3 * 3 * 2 + 5 - 7));
    // Nine places of force and curvature at two temperatures, of which one is whole; and the checks.
    assert_eq!(groups.into_inner(), 18 - 2 + 5);
    let Next::Finished(swept) = next_batch(&plan, &store).unwrap() else {
        panic!("everything is solved");
    };
    let whole = sweep(&plan, |p| Ok::<_, Infallible>(slid(p))).unwrap();
    assert!(swept.table.nodes() == whole.table.nodes());
    assert!(swept.table.checks() == whole.table.checks());
}
