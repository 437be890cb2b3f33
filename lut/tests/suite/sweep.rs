//! Sweeps: given points, refinement, determinism, and what they refuse.

use crate::hertz::{hertz, runner};
use kufe_lut::{
    AxisKind, Error, Figures, Interpolator, Mode, Plan, Point, Progress, Quantity, Spacing,
    SweepError, replay, sweep,
};
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

fn range(from: f64, to: f64) -> Spacing {
    Spacing::Range { from, to }
}

fn p_max(figures: &Figures) -> f64 {
    figures.get(Quantity::PMax).unwrap()
}

fn straight(point: &Point) -> Point {
    Point {
        curvature: 0.0,
        ..*point
    }
}

fn unseen(n: usize) -> Vec<Point> {
    // A sequence other than the sweep's own: golden-ratio steps.
    (0..n)
        .map(|i| {
            let t = (i as f64 * 0.618_033_988_749_895).fract();
            let u = (i as f64 + 0.5) / n as f64;
            Point {
                fz: 200.0 * 40f64.powf(t),
                curvature: -0.02 + 0.05 * u,
                ..Point::default()
            }
        })
        .collect()
}

#[test]
fn refinement_reaches_its_tolerance_at_points_it_never_saw() {
    for requested in [0.02, 0.005] {
        let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 0.03));
        plan.interpolation = requested;
        let solves = AtomicUsize::new(0);
        let swept = sweep(&plan, |point| {
            solves.fetch_add(1, Ordering::Relaxed);
            Ok::<_, Infallible>(runner(point))
        })
        .unwrap();
        assert!(swept.shortfall.is_none());
        let table = swept.table;
        assert_eq!(
            table.axes().node_count() + table.checks().len(),
            solves.into_inner()
        );
        assert!(table.checks().len() >= 200);
        for mode in Mode::ALL {
            let measured = table
                .interpolation_error(Quantity::PMax, mode)
                .unwrap()
                .unwrap();
            assert!(measured.max <= requested && measured.rms < measured.max);
            let lookup = Interpolator::new(&table, Quantity::PMax, mode, None).unwrap();
            for point in unseen(1000) {
                let truth = p_max(&runner(&point));
                let error = (lookup.at(Point::at_rest(point.fz, point.curvature)).value / truth
                    - 1.0)
                    .abs();
                assert!(error <= requested, "{mode:?} {point}: {error}");
            }
        }
    }
}

#[test]
fn the_smooth_mode_alone_needs_fewer_nodes() {
    let nodes = |modes: Vec<Mode>| {
        let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 0.03));
        plan.interpolation = 0.002;
        plan.modes = modes;
        let swept = sweep(&plan, |point| Ok::<_, Infallible>(runner(point))).unwrap();
        swept.table.axes().node_count()
    };
    assert!(2 * nodes(vec![Mode::Smooth]) < nodes(vec![Mode::Bilinear]));
}

#[test]
fn a_kink_is_refined_where_it_is() {
    // Peak pressure of a contact that splits in two: a V in curvature whose bottom moves with the
    // load.
    let kinked = |point: &Point| {
        let bottom = 1.0 / 30.0 + 1e-7 * point.fz;
        let p_max =
            1e8 * (point.fz / 1000.0).cbrt() * (0.2 + 20.0 * (point.curvature - bottom).abs());
        Ok::<_, Infallible>(runner(&straight(point)).with(Quantity::PMax, p_max))
    };
    let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 1.0 / 12.0));
    plan.interpolation = 0.01;
    let swept = sweep(&plan, kinked).unwrap();
    assert!(swept.shortfall.is_none(), "{:?}", swept.shortfall);
    let curvature = swept.table.axes().curvature();
    let finest = curvature
        .windows(2)
        .min_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))
        .unwrap();
    assert!((finest[0] - 1.0 / 30.0).abs() < 3e-3, "{finest:?}");
}

/// A runner of bounded length: its peak depends on force and on
/// `(curvature - flush) / (scale force)`, with a V next to 0.
fn fits_the_track(point: &Point) -> Result<Figures, Infallible> {
    let u = (point.curvature - FLUSH[0]) / (FLUSH[1] * point.fz);
    let v = u + 0.3;
    let p_max = 1e6
        * point.fz.sqrt()
        * if v < 0.0 {
            1.0 - 0.2 * v / (1.0 - v).powf(0.7)
        } else {
            1.0 + 0.8 * v / (1.0 + v).powf(0.6)
        };
    Ok(runner(&straight(point)).with(Quantity::PMax, p_max))
}

const FLUSH: [f64; 2] = [1.0 / 30.0, 1e-8];

#[test]
fn reduced_curvatures_resolve_a_v_that_moves_with_the_load() {
    let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 1.0 / 12.0));
    plan.modes = vec![Mode::Smooth];
    plan.max_nodes = 1000;
    let plain = sweep(&plan, fits_the_track).unwrap();
    assert!(
        matches!(plain.shortfall, Some(Error::ToleranceNotReached { .. })),
        "plain curvatures do as well: the test shows nothing"
    );
    plan.flush = Some(FLUSH);
    let swept = sweep(&plan, fits_the_track).unwrap();
    assert!(swept.shortfall.is_none(), "{:?}", swept.shortfall);
    let flush = *swept.table.axes().flush().unwrap();
    let lookup = Interpolator::new(&swept.table, Quantity::PMax, Mode::Smooth, None).unwrap();
    for (n, mut point) in unseen(2000).into_iter().enumerate() {
        // Half of them spread over curvatures, half over reduced ones, which the V fills.
        let t = (n as f64 + 0.5) / 2000.0;
        point.curvature = match n % 2 {
            0 => -0.02 + (1.0 / 12.0 + 0.02) * t,
            _ => flush.curvature(point.fz, t),
        };
        let truth = p_max(&fits_the_track(&point).unwrap());
        let found = lookup.at(Point::at_rest(point.fz, point.curvature));
        assert!(!found.out_of_range);
        assert!((found.value / truth - 1.0).abs() < 0.015, "{point}");
    }
    for (point, node) in swept.table.axes().points().iter().zip(swept.table.nodes()) {
        let found = lookup.at(Point::at_rest(point.fz, point.curvature)).value;
        assert!((found / p_max(node) - 1.0).abs() < 1e-9, "{point}");
    }
    assert!(
        lookup.at(Point::at_rest(300.0, 0.0834)).out_of_range
            && lookup.at(Point::at_rest(300.0, -0.0201)).out_of_range
    );
    assert!(lookup.at(Point::at_rest(300.0, f64::NAN)).value.is_nan());
}

#[test]
fn no_interval_is_halved_below_the_smallest() {
    let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 1.0 / 12.0));
    plan.modes = vec![Mode::Smooth];
    plan.max_nodes = 100_000;
    plan.smallest_interval = 0.01;
    let swept = sweep(&plan, fits_the_track).unwrap();
    let text = swept.shortfall.unwrap().to_string();
    assert!(text.contains("as small as allowed"), "{text}");
    let axes = swept.table.axes();
    let parts = |values: Vec<f64>| {
        let whole = values[values.len() - 1] - values[0];
        let parts = values
            .windows(2)
            .map(move |pair| (pair[1] - pair[0]) / whole);
        parts.fold(f64::INFINITY, f64::min)
    };
    // Halves of the last interval above 1.5 times the smallest.
    let finest = parts(axes.curvature().to_vec());
    assert!((0.0075..0.015).contains(&finest), "{finest}");
    assert!(parts(axes.fz().iter().map(|fz| fz.ln()).collect()) >= 0.0075);
}

#[test]
fn the_table_has_the_same_bytes_for_any_number_of_threads() {
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let plan = Plan::new(
                range(200.0, 8000.0),
                Spacing::Values(vec![-0.01, 0.0, 0.02]),
            );
            let swept = sweep(&plan, |point| Ok::<_, Infallible>(runner(point))).unwrap();
            let mut bytes = Vec::new();
            swept.table.write(&mut bytes).unwrap();
            bytes
        })
    };
    assert!(bytes(1) == bytes(3));
}

#[test]
fn given_points_are_the_nodes_and_the_error_between_them_is_measured() {
    let plan = Plan::new(
        Spacing::Values(vec![250.0, 1000.0, 4000.0]),
        Spacing::Values(vec![0.0, 0.01, 0.02]),
    );
    let swept = sweep(&plan, |point| Ok::<_, Infallible>(runner(point))).unwrap();
    let table = swept.table;
    assert_eq!(table.axes().fz(), [250.0, 1000.0, 4000.0]);
    assert_eq!(table.checks().len(), 4);
    let rough = table
        .interpolation_error(Quantity::PMax, Mode::Bilinear)
        .unwrap()
        .unwrap();
    let smooth = table
        .interpolation_error(Quantity::PMax, Mode::Smooth)
        .unwrap()
        .unwrap();
    assert!(
        smooth.max < 0.01 && rough.max > 0.01,
        "{smooth:?} {rough:?}"
    );
}

#[test]
fn given_values_on_other_axes_do_not_keep_a_range_from_ending() {
    let mut plan = Plan::new(Spacing::Values(vec![250.0, 8000.0]), range(0.0, 0.025));
    plan.interpolation = 0.01;
    let swept = sweep(&plan, |point| Ok::<_, Infallible>(runner(point))).unwrap();
    assert!(swept.shortfall.is_none());
    let rough = swept
        .table
        .interpolation_error(Quantity::PMax, Mode::Bilinear)
        .unwrap()
        .unwrap();
    assert!(
        rough.max > 0.05,
        "between the given loads the error is measured: {rough:?}"
    );
}

#[test]
fn a_rocker_axis_is_refined_too() {
    let mut plan = Plan::new(range(300.0, 4000.0), range(0.0, 0.01));
    plan = plan.with(AxisKind::RockerRadius, range(20.0, 50.0));
    plan.interpolation = 0.01;
    let swept = sweep(&plan, |point| Ok::<_, Infallible>(runner(point))).unwrap();
    assert!(swept.shortfall.is_none());
    for mode in Mode::ALL {
        let lookup = Interpolator::new(&swept.table, Quantity::PMax, mode, Some(33.3)).unwrap();
        let point = Point {
            fz: 1111.0,
            curvature: 0.0077,
            rocker_radius: Some(33.3),
            ..Point::default()
        };
        let error = lookup.at(Point::at_rest(point.fz, point.curvature)).value
            / p_max(&runner(&point))
            - 1.0;
        assert!(error.abs() < 0.01, "{mode:?} {error}");
    }
}

#[test]
fn a_limit_gives_the_table_and_reports_what_it_missed() {
    let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 0.03));
    plan.interpolation = 1e-5;
    plan.max_nodes = 300;
    let swept = sweep(&plan, |point| Ok::<_, Infallible>(runner(point))).unwrap();
    match swept.shortfall {
        Some(Error::ToleranceNotReached {
            measured,
            requested,
            nodes,
            ..
        }) => {
            assert!(measured > requested && nodes <= 300);
            assert_eq!(nodes, swept.table.axes().node_count());
        }
        other => panic!("{other:?}"),
    }
}

#[derive(Debug, thiserror::Error)]
#[error("no ice at {0} N")]
struct NoIce(f64);

#[test]
fn failures_name_the_point_and_bad_ranges_the_axis() {
    let plan = Plan::new(range(200.0, 8000.0), range(0.0, 0.02));
    let failed = sweep(&plan, |point| {
        if point.fz > 7000.0 {
            Err(NoIce(point.fz))
        } else {
            Ok(runner(point))
        }
    });
    match failed {
        Err(SweepError::Solve { point, source }) => assert_eq!(point.fz, source.0),
        other => panic!("{other:?}"),
    }
    let text = failed_text(&Plan::new(range(800.0, 200.0), range(0.0, 0.02)));
    assert!(text.contains("fz_n") && text.contains("200"), "{text}");
    let text = failed_text(&Plan::new(range(-1.0, 200.0), range(0.0, 0.02)));
    assert!(text.contains("positive"), "{text}");
    let text = failed_text(&Plan::new(
        Spacing::Values(vec![1.0, 1.0]),
        range(0.0, 0.02),
    ));
    assert!(text.contains("above the one before"), "{text}");
    let mut plan = Plan::new(range(200.0, 8000.0), range(0.0, 0.02));
    plan.interpolation = f64::NAN;
    assert!(failed_text(&plan).contains("interpolation"));
}

fn failed_text(plan: &Plan) -> String {
    sweep(plan, |point| Ok::<_, Infallible>(runner(point)))
        .unwrap_err()
        .to_string()
}

#[test]
fn a_figure_that_is_not_finite_is_refused() {
    let plan = Plan::new(range(200.0, 8000.0), range(0.0, 0.02));
    let failed = sweep(&plan, |point| {
        Ok::<_, Infallible>(runner(point).with(Quantity::Approach, f64::NAN))
    });
    assert!(failed.unwrap_err().to_string().contains("approach_m"));
}

#[test]
fn the_solvers_own_error_is_not_chased() {
    // Half a percent of scatter that no interpolation can follow, reported as such.
    let noisy = |point: &Point| {
        let truth = runner(point);
        let scatter = 0.005 * (1e3 * point.fz + 1e7 * point.curvature).sin();
        let p_max = p_max(&truth) * (1.0 + scatter);
        let noisy = truth.with(Quantity::PMax, p_max);
        Ok::<_, Infallible>(noisy.with_error(Quantity::PMax, 0.005 * p_max))
    };
    let mut plan = Plan::new(range(200.0, 8000.0), range(-0.02, 0.03));
    plan.interpolation = 0.005;
    let swept = sweep(&plan, noisy).unwrap();
    assert!(
        swept.table.axes().node_count() < 1500,
        "{}",
        swept.table.axes().node_count()
    );
    let text = swept.shortfall.unwrap().to_string();
    assert!(text.contains("the solver's own error"), "{text}");
}

#[test]
fn anchors_are_nodes_at_the_corners_and_in_the_middle() {
    let mut plan = Plan::new(
        Spacing::Range {
            from: 200.0,
            to: 8000.0,
        },
        Spacing::Values(vec![0.0, 0.01, 0.03]),
    );
    let anchors = plan.anchors().unwrap();
    let of: Vec<[f64; 2]> = anchors.iter().map(|p| [p.fz, p.curvature]).collect();
    assert_eq!(
        of[..4],
        [[200.0, 0.0], [200.0, 0.03], [8000.0, 0.0], [8000.0, 0.03]]
    );
    assert!(
        (of[4][0] - 1264.911).abs() < 1e-3 && of[4][1] == 0.01,
        "{of:?}"
    );
    let swept = sweep(&plan, |point| {
        Ok::<_, Infallible>(hertz(point.fz, 30.0, 0.005))
    })
    .unwrap();
    let nodes = swept.table.axes().points();
    assert!(anchors.iter().all(|anchor| nodes.contains(anchor)));
    plan = Plan::new(
        Spacing::Values(vec![500.0, 900.0]),
        Spacing::Values(vec![0.0]),
    );
    assert_eq!(plan.anchors().unwrap().len(), 2);
}

#[test]
fn rounds_of_batches_give_the_table_of_one_process_to_the_bit() {
    let plan = Plan::new(range(200.0, 8000.0), range(-0.02, 0.03));
    let mut solved: Vec<(Point, Figures)> = Vec::new();
    let mut rounds = 0;
    let table = loop {
        let stored = |point: &Point| {
            let found = solved.iter().find(|(known, _)| known == point);
            found.map(|(_, figures)| *figures)
        };
        match replay(&plan, stored).unwrap() {
            Progress::Finished(swept) => break swept.table,
            Progress::Batch { points, round, .. } => {
                rounds += 1;
                assert_eq!(round, rounds);
                // In any order.
                solved.extend(points.iter().rev().map(|p| (*p, runner(p))));
            }
        }
    };
    assert!(rounds > 1, "a tolerance needs rounds");
    let whole = sweep(&plan, |p| Ok::<_, Infallible>(runner(p))).unwrap();
    assert!(table == whole.table);
}
