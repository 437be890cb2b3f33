//! Runs with gaps: samples next to a gap are excluded, all others are unchanged.

use std::sync::LazyLock;

use kufe_sled::sample_data::{drive_sample, sample_plan};
use kufe_sled::{
    Gaps, Model, OnGaps, PrepareOptions, Prepared, Run, RunFormat, State, Vehicle, evaluate, fit,
    prepare, prepare_all, read_run, validate, write_run,
};

/// Samples per state, and number of states excluded on either side of a gap: two periods of 20 Hz
/// at 100 Hz, and three for the derivative.
const RATIO: usize = 5;
const MARGIN: usize = 13;

static RUNS: LazyLock<Vec<Run>> = LazyLock::new(|| {
    let model = Model::published();
    let plan: Vec<_> = sample_plan(1).into_iter().step_by(4).take(6).collect();
    drive_sample(&plan, &model).unwrap()
});

fn prepared(runs: &[Run]) -> Vec<Prepared> {
    let model = Model::published();
    let vehicle = Vehicle::new(&model).unwrap();
    prepare_all(
        runs,
        &vehicle,
        model.noise.as_ref(),
        &PrepareOptions::default(),
    )
    .unwrap()
}

/// The run written without these rows and values, and read again.
fn damaged(
    run: &Run,
    rows: &[std::ops::Range<usize>],
    values: &[(&str, std::ops::Range<usize>)],
) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    let mut spoilt = run.clone();
    for (column, removed) in values {
        spoilt.columns.get_mut(*column).unwrap()[removed.clone()].fill(f64::NAN);
    }
    write_run(&spoilt, &mut bytes, RunFormat::Csv).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let retained = text.lines().enumerate().filter(|(line, _)| {
        *line == 0 || !rows.iter().any(|removed| removed.contains(&(line - 1)))
    });
    let lines: Vec<&str> = retained.map(|(_, line)| line).collect();
    let mut entry = run.entry.clone();
    entry.file = folder.path().join("run.csv");
    std::fs::write(&entry.file, lines.join("\n") + "\n").unwrap();
    read_run(entry, &kufe_sled::COLUMNS, OnGaps::LeaveOut).unwrap()
}

/// The run without random rows and values, about a twentieth of it. The generator is independent of
/// the library.
fn with_a_twentieth_missing(run: &Run, seed: u64) -> Run {
    let mut state = seed;
    let mut draw = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    let (mut rows, mut values, mut removed) = (Vec::new(), Vec::new(), 0);
    while 20 * removed < run.len() {
        let length = 20 + draw(400);
        let from = draw(run.len() - length);
        if draw(2) == 0 {
            rows.push(from..from + length);
        } else {
            values.push((kufe_sled::COLUMNS[draw(10)], from..from + length));
        }
        removed += length;
    }
    damaged(run, &rows, &values)
}

#[test]
fn fits_with_a_twentieth_missing_agree_within_the_intervals() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let holed: Vec<Run> = (1..)
        .zip(RUNS.iter())
        .map(|(k, run)| with_a_twentieth_missing(run, k))
        .collect();
    let (whole, holed) = (prepared(&RUNS), prepared(&holed));
    let of = |runs: &[Prepared]| fit(runs, &vehicle, true).unwrap();
    let (clean, gaps) = (of(&whole), of(&holed));
    for (a, b) in [(&clean.front, &gaps.front), (&clean.rear, &gaps.rear)] {
        for (a, b) in [(a.k_n_per_rad, b.k_n_per_rad), (a.mu_zeta_c, b.mu_zeta_c)] {
            // Nine tenths of the samples are the same: the difference is less than either
            // confidence interval.
            let ends = |of: kufe_sled::friction::Interval| [of.low.unwrap(), of.high.unwrap()];
            let ([low, high], [b_low, b_high]) = (ends(a), ends(b));
            assert!((low..high).contains(&b.value), "{a:?} {b:?}");
            let wider = (b_high - b_low) / (high - low);
            assert!((0.7..1.5).contains(&wider), "{wider}");
        }
    }
    // Evaluation and validation of a run with gaps are close to those of the whole run.
    let scores = |runs: &[Prepared]| evaluate(runs, &vehicle);
    for (a, b) in scores(&whole).iter().zip(&scores(&holed)) {
        assert!(
            (a.time_s - b.time_s).abs() < 0.9,
            "{} {}",
            a.time_s,
            b.time_s
        );
        // A relative loss: removing a tenth of the run changes it by at most a tenth of its spread
        // along the run.
        assert!((a.increase_total / b.increase_total - 1.0).abs() < 0.1);
    }
    for (a, b) in validate(&whole, &vehicle)
        .iter()
        .zip(&validate(&holed, &vehicle))
    {
        assert!(
            (a.rmse_n / b.rmse_n - 1.0).abs() < 0.15,
            "{} {}",
            a.rmse_n,
            b.rmse_n
        );
        let states = &holed.iter().find(|run| run.entry.run == b.run).unwrap();
        for largest in &b.largest {
            let at = states
                .states
                .iter()
                .position(|s| s.t_s == largest.t_s)
                .unwrap();
            let piece = states
                .pieces
                .iter()
                .find(|piece| piece.contains(&at))
                .unwrap();
            assert!(
                at >= piece.start + 25 && at + 25 <= piece.end,
                "the window spans a gap"
            );
        }
    }
}

#[test]
fn each_stretch_equals_a_separate_run_without_its_margins() {
    // Reference: the stretch alone, prepared as a whole run, without the samples next to the gap.
    let run = &RUNS[0];
    let removed = [4000..4100, 9000..9995];
    let holed = &prepared(&[damaged(run, &removed, &[])])[0];
    let retained = [0..4000, 4100..9000, 9995..run.len()];
    assert_eq!(holed.pieces.len(), 3);
    for (number, (retained, piece)) in retained.iter().zip(&holed.pieces).enumerate() {
        let mut separate = run.clone();
        for column in separate.columns.values_mut() {
            // A file stores nine decimals.
            *column = column[retained.clone()]
                .iter()
                .map(|x| (x * 1e9).round() / 1e9)
                .collect();
        }
        separate.gaps = Gaps::none(retained.len());
        separate.t0_s = retained.start as f64 * run.dt_s;
        let separate = &prepared(&[separate])[0];
        let from = if number == 0 { 0 } else { MARGIN };
        let to = separate.states.len() - if number == 2 { 0 } else { MARGIN };
        assert_eq!(piece.len(), to - from);
        for (a, b) in holed.states[piece.clone()]
            .iter()
            .zip(&separate.states[from..to])
        {
            assert!((a.t_s - b.t_s).abs() < 1e-9, "{} {}", a.t_s, b.t_s);
            // The arithmetic is identical except for the time, which enters no channel. Values that
            // are not stated are NaN, hence the comparison as text.
            let channels = |state: &State| format!("{:?}", State { t_s: 0.0, ..*state });
            assert_eq!(channels(a), channels(b));
        }
    }
    let marked = (0..run.len()).step_by(RATIO).filter(|sample| {
        let near = |removed: &std::ops::Range<usize>| {
            // A state is retained if the gap is more than the margin away.
            let reach = MARGIN * RATIO;
            sample + reach >= removed.start && *sample < removed.end + reach
        };
        !removed.iter().any(near)
    });
    assert_eq!(holed.states.len(), marked.count());
}

#[test]
fn filtered_values_near_a_gap_agree_with_the_whole_run_within_one_percent() {
    let run = &RUNS[0];
    let whole = &prepared(std::slice::from_ref(run))[0];
    let holed = &prepared(&[damaged(run, std::slice::from_ref(&(6000..6100)), &[])])[0];
    let spread = |of: fn(&kufe_sled::State) -> f64| {
        let mean = whole.states.iter().map(of).sum::<f64>() / whole.states.len() as f64;
        let squares = whole
            .states
            .iter()
            .map(|s| (of(s) - mean).powi(2))
            .sum::<f64>();
        (squares / whole.states.len() as f64).sqrt()
    };
    for of in [
        |s: &kufe_sled::State| s.alpha_f_rad,
        |s| s.yaw_rate_radps,
        |s| s.accel_mps2[1],
        |s| s.fz_r_n,
    ] as [fn(&kufe_sled::State) -> f64; 4]
    {
        for state in &holed.states {
            let same = &whole.states[(state.t_s * 100.0).round() as usize];
            assert!(
                (of(state) - of(same)).abs() < 0.01 * spread(of),
                "t = {}",
                state.t_s
            );
        }
    }
}

#[test]
fn integrated_distance_continues_across_a_gap_of_the_speed() {
    let mut run = RUNS[0].clone();
    let truth = run.columns["s_m"].clone();
    run.columns.remove("s_m");
    let removed = 6000..6500;
    let holed = &prepared(&[damaged(&run, &[], &[("v_mps", removed.clone())])])[0];
    let s = |i: usize| truth[RATIO * i] - truth[0];
    let last = holed.states.last().unwrap();
    // A straight line across T = 1 s has an error of at most (change of the acceleration) T^2 / 12,
    // here below 0.5 m. Noise of the speed and the trapezoidal rule contribute far less.
    let at = (last.t_s * 100.0).round() as usize;
    assert!((last.s_m - s(at)).abs() < 0.5, "{} {}", last.s_m, s(at));
    // A gap in another channel does not change the distance.
    let other = &prepared(&[damaged(&run, &[], &[("ay_mps2", removed)])])[0];
    let whole = &prepared(&[run])[0];
    let (a, b) = (
        other.states.last().unwrap().s_m,
        whole.states.last().unwrap().s_m,
    );
    assert!((a - b).abs() < 5e-3, "{a} {b}");
}

#[test]
fn standstill_and_missing_values_at_the_ends_are_cut_off() {
    let mut run = RUNS[0].clone();
    let len = run.len();
    let v = run.columns.get_mut("v_mps").unwrap();
    v[..700].fill(0.0);
    v[len - 300..].fill(0.02);
    let read = damaged(&run, &[], &[("alpha_rad", 700..800)]);
    assert_eq!(read.len(), len - 1100);
    assert!((read.t0_s - 1.6).abs() < 1e-9);
    let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(close(read.gaps.cut_s[0], 1.6) && close(read.gaps.cut_s[1], 0.6));
    assert_eq!(read.gaps.pieces, Gaps::none(len - 1100).pieces);
    let model = Model::published();
    let vehicle = Vehicle::new(&model).unwrap();
    let states = prepare(&read, &vehicle, None, &PrepareOptions::default()).unwrap();
    assert!(close(states.states[0].t_s, 1.6) && states.pieces.len() == 1);
}
