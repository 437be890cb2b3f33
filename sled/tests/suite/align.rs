//! Runs with a shifted and stretched distance are aligned with one another and with a track.

use kufe_sled::sample_data::{drive_sample, sample_plan, sample_track};
use kufe_sled::{
    Aligned, Driver, Model, PrepareOptions, Prepared, Run, SimulateOptions, Tolerances, Track,
    TrackEstimate, TrackShape, Vehicle, align, prepare, simulate, state_places,
};

/// Sample runs on `east` by every driver, each with its own shift [m] and stretch, and the true
/// distance of every row [m].
fn shifted(count: usize) -> (Vec<Run>, Vec<Vec<f64>>) {
    let model = Model::published();
    let plan = sample_plan(1);
    let east: Vec<_> = plan.iter().filter(|run| run.track == "east").collect();
    let every = east.len() / count;
    let planned = east.into_iter().step_by(every).take(count).cloned();
    let mut runs = drive_sample(&planned.collect::<Vec<_>>(), &model).unwrap();
    let mut truth = Vec::new();
    for (i, run) in runs.iter_mut().enumerate() {
        // 5 m to 60 m late on the track, and alternately half a per cent longer or shorter.
        let share = i as f64 / (count - 1) as f64;
        let (late, stretch) = (5.0 + 55.0 * share, if i % 2 == 0 { 1.005 } else { 0.995 });
        let places = &run.columns["s_m"];
        let first = places.iter().position(|s| *s >= late).unwrap();
        let kept = run.len() - first;
        for column in run.columns.values_mut() {
            column.drain(..first);
        }
        run.t0_s += first as f64 * run.dt_s;
        run.gaps = kufe_sled::Gaps::none(kept);
        let places = run.columns["s_m"].clone();
        let own = places.iter().map(|s| (s - places[0]) / stretch).collect();
        run.columns.insert("s_m".to_string(), own);
        truth.push(places);
    }
    (runs, truth)
}

fn prepared(runs: &[Run], vehicle: &Vehicle) -> Vec<Prepared> {
    let options = PrepareOptions::default();
    let prepared = runs.iter().map(|run| prepare(run, vehicle, None, &options));
    prepared.collect::<Result<_, _>>().unwrap()
}

fn aligned(runs: &[Run], vehicle: &Vehicle, survey: Option<&TrackShape>) -> Aligned {
    let prepared = prepared(runs, vehicle);
    let prepared: Vec<&Prepared> = prepared.iter().collect();
    align(&prepared, vehicle, survey, &Tolerances::default()).unwrap()
}

/// The largest position error of every run [m], after the shift `common` of all runs.
fn errors(runs: &[Run], truth: &[Vec<f64>], found: &Aligned, common: f64) -> Vec<f64> {
    let placed = runs.iter().zip(truth).zip(&found.runs);
    placed
        .map(|((run, truth), found)| {
            let mut run = run.clone();
            state_places(&mut run, &found.warp).unwrap();
            let places = run.columns["s_m"].iter().zip(truth);
            places
                .map(|(s, truth)| (s + common - truth).abs())
                .fold(0.0, f64::max)
        })
        .collect()
}

#[test]
fn shifted_and_stretched_runs_align_with_the_survey_within_their_errors() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let (runs, truth) = shifted(8);
    let shape = TrackShape::new(&sample_track("east"));
    let found = aligned(&runs, &vehicle, Some(&shape));
    let errors = errors(&runs, &truth, &found, 0.0);
    println!("largest errors [m]: {errors:.3?}");
    // Drivers take different lines through the curves, which shifts the measured features of the
    // track.
    for (error, run) in errors.iter().zip(&found.runs) {
        assert!(*error < 5.0, "{}: {error} m", run.run);
        // The stated error is the largest one along the run.
        assert!(
            *error < 5.0 * run.sd_m,
            "{}: {error} m, {}",
            run.run,
            run.sd_m
        );
    }
    // The error of every knot relative to its stated error.
    let mut off = Vec::new();
    for ((run, truth), found) in runs.iter().zip(&truth).zip(&found.runs) {
        let own = &run.columns["s_m"];
        for (knot, sd) in found.warp.own_m.iter().zip(&found.warp.sd_m) {
            let row = own.iter().position(|s| s >= knot).unwrap_or(own.len() - 1);
            off.push((found.warp.at(own[row]) - truth[row]) / sd);
        }
    }
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let outliers = off.iter().filter(|off| off.abs() > 3.0).count() as f64 / off.len() as f64;
    println!(
        "RMS error / stated error {rms:.2}, {:.1} % above 3",
        100.0 * outliers
    );
    assert!(rms < 2.0 && outliers < 0.1, "{off:.1?}");
}

#[test]
fn runs_without_a_survey_align_and_give_the_track_within_its_errors() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let (runs, truth) = shifted(8);
    let found = aligned(&runs, &vehicle, None);
    // The earliest start defines 0; its true position is 5 m.
    let common = truth[0][0] - found.runs[0].start_m;
    assert!(found.runs.iter().all(|run| run.start_m > -0.5));
    let errors = errors(&runs, &truth, &found, common);
    println!("largest errors [m]: {errors:.3?}, common shift {common}");
    assert!(errors.iter().all(|error| *error < 5.0), "{errors:?}");

    let TrackEstimate {
        track,
        sd,
        runs: count,
    } = found.estimate.unwrap();
    assert!(count.iter().all(|count| *count >= 2));
    let known = TrackShape::new(&sample_track("east"));
    let columns = [
        ("slope", &track.slope_rad, &known.slope),
        ("curvature", &track.curvature_1pm, &known.curvature),
        ("bank", &track.bank_rad, &known.bank),
    ];
    for ((name, values, truth), sd) in columns.into_iter().zip(&sd) {
        let off: Vec<f64> = (0..values.len())
            .map(|i| (values[i] - truth.value(track.s_m[i] + common)) / sd[i])
            .collect();
        let mean_square = off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64;
        let outliers = off.iter().filter(|off| off.abs() > 3.0).count() as f64 / off.len() as f64;
        let plain = (0..values.len())
            .map(|i| (values[i] - truth.value(track.s_m[i] + common)).powi(2))
            .sum::<f64>()
            / off.len() as f64;
        println!(
            "{name}: RMS error / stated error {:.2}, {:.1} % above 3; RMS error {:.2e}",
            mean_square.sqrt(),
            100.0 * outliers,
            plain.sqrt()
        );
        assert!(mean_square.sqrt() < 1.5 && outliers < 0.03, "{name}");
    }
}

#[test]
fn run_time_on_the_estimated_track_equals_that_on_the_true_one() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let (runs, truth) = shifted(8);
    let found = aligned(&runs, &vehicle, None);
    let common = truth[0][0] - found.runs[0].start_m;
    let estimate = found.estimate.unwrap();
    let mut file = Vec::new();
    estimate.write_csv(&mut file).unwrap();
    let read = Track::from_csv(file.as_slice(), "east", "track_east.csv").unwrap();
    assert_eq!(read.s_m.len(), estimate.track.s_m.len());
    let mut part = sample_track("east");
    let (from, to) = (read.s_m[0] + common, read.s_m[read.s_m.len() - 1] + common);
    let keep: Vec<bool> = part.s_m.iter().map(|s| (from..=to).contains(s)).collect();
    for column in [
        &mut part.s_m,
        &mut part.slope_rad,
        &mut part.curvature_1pm,
        &mut part.bank_rad,
    ] {
        let mut kept = keep.iter();
        column.retain(|_| *kept.next().unwrap());
    }
    let time = |track: &Track| {
        let options = SimulateOptions::default();
        let driver = Driver::of_skill(1.0);
        let driven = simulate(&vehicle, &TrackShape::new(track), &driver, &options).unwrap();
        assert!(driven.finished);
        driven.instants.last().unwrap().state.t_s
    };
    let (estimated, truth) = (time(&read), time(&part));
    println!("{estimated} s on the estimated track, {truth} s on the true one");
    // The slope of 0.1 rad has a constant error below 0.002 rad, which is 1 % of the time.
    assert!((estimated / truth - 1.0).abs() < 0.01);
}

#[test]
fn a_run_on_another_track_is_refused_by_name() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let (runs, _) = shifted(2);
    let prepared = prepared(&runs, &vehicle);
    let prepared: Vec<&Prepared> = prepared.iter().collect();
    let west = TrackShape::new(&sample_track("west"));
    let error = align(&prepared, &vehicle, Some(&west), &Tolerances::default());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("east") && error.contains(".csv"), "{error}");
}
