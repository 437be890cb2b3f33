//! Examination of runs with one fault each: gaps, drop-outs, jitter, saturation, quantisation,
//! constant channels, exchanged channels.

use std::path::Path;

use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Examination, FaultKind, Model, Noise, Run, RunFormat, Saturation, SimulateOptions,
    TrackShape, Vehicle, check_relations, examine, find_faults, record, simulate, simulated_entry,
    write_run,
};

/// A run with sensor noise at 100 Hz.
fn clean() -> Run {
    let model = Model::published();
    let vehicle = Vehicle::new(&model).unwrap();
    let track = sample_track("west");
    let options = SimulateOptions {
        rate_hz: 100.0,
        ..SimulateOptions::default()
    };
    let driver = Driver::of_skill(0.5);
    let simulated = simulate(&vehicle, &TrackShape::new(&track), &driver, &options).unwrap();
    let noise = Noise {
        accel_mps2: 0.2,
        rate_radps: 0.0015,
        speed_mps: 0.03,
        slip_rad: 0.0005,
        steer_rad: 0.0004,
        roll_split_rad: 0.0004,
    };
    let entry = simulated_entry("r", &track, "d", options.conditions);
    record(&simulated, &vehicle, Some(&noise), entry, 1)
}

/// The examination of the run with the lines of its file changed.
fn examine_lines(run: &Run, lines: impl Fn(Vec<String>) -> Vec<String>) -> Examination {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    let mut file = std::fs::File::create(&path).unwrap();
    write_run(run, &mut file, RunFormat::Csv).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let lines = lines(text.lines().map(str::to_owned).collect());
    std::fs::write(&path, lines.join("\n") + "\n").unwrap();
    examine_file(folder.path())
}

fn examine_file(folder: &Path) -> Examination {
    let index = folder.join("runs.csv");
    std::fs::write(&index, "run,file\nr,r.csv\n").unwrap();
    examine(&index).unwrap().remove(0).0
}

/// The examination of the run with a column changed.
fn changed(column: &str, change: impl Fn(usize, f64) -> f64) -> Examination {
    let mut run = clean();
    let values = run.columns.get_mut(column).unwrap();
    for (i, x) in values.iter_mut().enumerate() {
        *x = change(i, *x);
    }
    examine_lines(&run, |lines| lines)
}

fn notes(of: &Examination, column: &str) -> String {
    let own = of.notes.iter().filter(|note| note.column == column);
    own.map(|note| note.what.as_str())
        .collect::<Vec<_>>()
        .join("; ")
}

#[test]
fn a_clean_run_has_no_findings() {
    let clean = examine_lines(&clean(), |lines| lines);
    assert!(
        !clean.is_wrong() && clean.notes.is_empty(),
        "{:?}",
        clean.notes
    );
    for (name, profile) in &clean.channels {
        let quiet = profile.leaps + profile.dropouts + profile.missing == 0;
        let still = profile.saturation.is_some() || profile.quantum.is_some();
        assert!(quiet && !still && profile.rows_held.is_none(), "{name}");
    }
}

#[test]
fn gaps_are_counted() {
    let gaps = examine_lines(&clean(), |mut lines| {
        lines.drain(1000..1300);
        lines
    });
    assert_eq!(gaps.gaps.rows_missing, 300);
    assert!(notes(&gaps, "").contains("300 rows missing"));
    assert!((gaps.length_s - gaps.used_s - 3.0).abs() < 0.011);
}

#[test]
fn drop_outs_of_one_and_of_twenty_samples_are_counted() {
    // The measured values are above 3 m/s2, far from the drop-out value 0.
    let single = changed("az_mps2", |i, x| if i % 500 == 250 { 0.0 } else { x });
    let expected = (clean().len() - 251) / 500 + 1;
    assert_eq!(single.channels["az_mps2"].leaps, expected);
    assert!(notes(&single, "az_mps2").contains("leap"));
    let short = changed(
        "az_mps2",
        |i, x| if i % 500 < 20 && i > 400 { 0.0 } else { x },
    );
    let expected = (clean().len() - 1) / 500;
    assert_eq!(short.channels["az_mps2"].dropouts, expected);
    assert!(notes(&short, "az_mps2").contains("drops out"));
}

#[test]
fn jitter_is_reported_relative_to_the_step() {
    let jitter = examine_lines(&clean(), |lines| {
        let moved = |(i, line): (usize, String)| match line.split_once(',') {
            Some((t, rest)) if i > 0 && i % 3 == 1 => {
                format!("{},{rest}", t.parse::<f64>().unwrap() + 0.0025)
            }
            _ => line,
        };
        lines.into_iter().enumerate().map(moved).collect()
    });
    assert!(
        (jitter.gaps.jitter - 0.25).abs() < 0.03,
        "{}",
        jitter.gaps.jitter
    );
    assert!(notes(&jitter, "t_s").contains("of a step off"));
}

#[test]
fn saturation_is_reported_at_both_ends_with_its_samples() {
    for (column, low, high) in [("az_mps2", 0.0, 14.0), ("yaw_rate_radps", -0.12, 9.0)] {
        let stopped = changed(column, |_, x| x.clamp(low, high));
        let stop = stopped.channels[column].saturation.unwrap();
        let run = clean();
        let clipped = run.columns[column]
            .iter()
            .filter(|x| **x <= low || **x >= high);
        let clipped = clipped.count();
        assert!(stop.at == low || stop.at == high, "{stop:?}");
        // Intervals shorter than eight samples do not count as saturated.
        assert!(
            stop.samples <= clipped && 2 * stop.samples > clipped,
            "{stop:?} of {clipped}"
        );
        assert!(
            notes(&stopped, column).contains("saturated"),
            "{:?}",
            stopped.notes
        );
    }
}

#[test]
fn quantisation_is_reported_with_its_step() {
    let step = 0.005;
    let coarse = changed("yaw_rate_radps", |_, x| (x / step).round() * step);
    let quantum = coarse.channels["yaw_rate_radps"].quantum.unwrap();
    assert!((quantum / step - 1.0).abs() < 1e-6, "{quantum}");
    assert!(notes(&coarse, "yaw_rate_radps").contains("steps of 5.00e-3"));
}

#[test]
fn a_constant_channel_is_noted_for_an_interval_and_a_fault_throughout() {
    let interval = changed("yaw_rate_radps", |i, x| {
        if (1500..1600).contains(&i) { 0.125 } else { x }
    });
    let still = interval.channels["yaw_rate_radps"].longest_still_s;
    assert!((still - 0.99).abs() < 0.011, "{still}");
    assert!(notes(&interval, "yaw_rate_radps").contains("one value for 0.99 s"));
    let throughout = changed("yaw_rate_radps", |_, _| 0.0);
    let fault = &throughout.faults[0];
    assert_eq!(fault.kind, FaultKind::Constant);
    assert_eq!(fault.columns, ["yaw_rate_radps"]);
}

#[test]
fn a_leap_or_frozen_interval_of_the_speed_is_reported_with_its_place() {
    let clean = clean();
    let s_m = clean.columns["v_mps"].iter().take(2000).sum::<f64>() * clean.dt_s;
    let doubled = |i: usize, x: f64| {
        if (2000..2010).contains(&i) {
            2.0 * x
        } else {
            x
        }
    };
    let found = changed("v_mps", doubled);
    assert_eq!(found.channels["v_mps"].leaps, 1);
    let t_s = clean.t0_s + 2000.0 * clean.dt_s;
    let leap = format!("leaps off from t = {t_s:.3} s (s = {s_m:.1} m) on for 0.100 s");
    assert!(
        notes(&found, "v_mps").contains(&leap),
        "{}",
        notes(&found, "v_mps")
    );
    let value = clean.columns["v_mps"][1000];
    let frozen = |i: usize, x: f64| if (1000..1800).contains(&i) { value } else { x };
    let found = changed("v_mps", frozen);
    let reported = notes(&found, "v_mps");
    let still = format!("one value for 7.99 s, {value:.9}");
    assert!(
        reported.contains(still.trim_end_matches('0')) && reported.contains("frozen?"),
        "{reported}"
    );
    // `check_relations` reports the same faults.
    for (change, word) in [
        (&doubled as &dyn Fn(usize, f64) -> f64, "leaps off"),
        (&frozen, "frozen?"),
    ] {
        let mut run = clean.clone();
        let values = run.columns.get_mut("v_mps").unwrap();
        values
            .iter_mut()
            .enumerate()
            .for_each(|(i, x)| *x = change(i, *x));
        let mut runs = [run];
        check_relations(&mut runs).unwrap();
        let remarks = runs[0].remarks.join("; ");
        assert!(
            remarks.contains("column v_mps") && remarks.contains(word),
            "{remarks}"
        );
    }
    let mut runs = [clean];
    check_relations(&mut runs).unwrap();
    assert_eq!(runs[0].remarks, [""; 0]);
}

#[test]
fn saturation_with_filter_overshoot_is_reported_as_saturation() {
    let peak = clean().columns["az_mps2"]
        .iter()
        .fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let stopped = changed("az_mps2", |i, x| {
        if (1500..1600).contains(&i) {
            0.99 * peak
        } else {
            x
        }
    });
    assert!(stopped.channels["az_mps2"].saturation.is_none());
    let reported = notes(&stopped, "az_mps2");
    assert!(
        reported.contains("one value for 0.99 s, at the end of its range: saturated?"),
        "{reported}"
    );
}

#[test]
fn repeated_samples_are_not_saturation() {
    let mut last = 0.0;
    let mut run = clean();
    for (i, x) in run.columns.get_mut("v_mps").unwrap().iter_mut().enumerate() {
        last = if i % 10 == 0 { *x } else { last };
        *x = last;
    }
    assert!(Saturation::of(&run.columns["v_mps"]).is_none());
}

#[test]
fn no_delay_of_ay_is_estimated_without_a_slip_sensor() {
    let mut run = clean();
    run.columns.remove("alpha_rad");
    let reported = examine_lines(&run, |lines| lines);
    assert!(reported.channels["ay_mps2"].delay_s.is_none());
    assert!(reported.channels["yaw_rate_radps"].delay_s.is_some());
}

#[test]
fn the_delay_of_a_late_channel_is_within_its_stated_error() {
    let clean = clean();
    for (column, most_error) in [("v_mps", 0.06), ("yaw_rate_radps", 0.02), ("az_mps2", 0.02)] {
        for rows in [10, 25, 60] {
            let values = &clean.columns[column];
            let late = changed(column, |i, _| values[i.saturating_sub(rows)]);
            let [delay, error] = late.channels[column].delay_s.unwrap();
            let off = delay - 0.01 * rows as f64;
            assert!(
                off.abs() < 3.0 * error && error < most_error,
                "{column}, {rows} rows: {delay} +- {error}"
            );
        }
    }
}

#[test]
fn exchanged_channels_are_a_fault_that_names_both() {
    let exchanged = examine_lines(&clean(), |mut lines| {
        lines[0] = lines[0]
            .replace("roll_rate", "?")
            .replace("pitch_rate", "roll_rate")
            .replace('?', "pitch_rate");
        lines
    });
    let fault = &exchanged.faults[0];
    assert_eq!(fault.kind, FaultKind::Swapped);
    assert_eq!(fault.columns, ["roll_rate_radps", "pitch_rate_radps"]);
    assert!(fault.mend.contains("exchange"), "{}", fault.mend);
}

/// The run as a measuring box records it that is rotated by roll, pitch and yaw [rad].
fn in_rotated_box(name: &str, [roll, pitch, yaw]: [f64; 3]) -> Run {
    let mut run = clean();
    run.entry.run = name.to_owned();
    for axes in [
        ["ax_mps2", "ay_mps2", "az_mps2"],
        ["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"],
    ] {
        for i in 0..run.len() {
            let [x, y, z] = axes.map(|axis| run.columns[axis][i]);
            let (s, c) = yaw.sin_cos();
            let [x, y] = [c * x + s * y, -s * x + c * y];
            let (s, c) = pitch.sin_cos();
            let [x, z] = [c * x - s * z, s * x + c * z];
            let (s, c) = roll.sin_cos();
            let own = [x, c * y + s * z, -s * y + c * z];
            for (axis, value) in axes.iter().zip(own) {
                run.columns.get_mut(*axis).unwrap()[i] = value;
            }
        }
    }
    run
}

#[test]
fn a_rotated_box_is_one_fault_with_its_rotation() {
    use std::f64::consts::{FRAC_PI_2, PI};
    for angles in [
        [PI, 0.0, 0.0],
        [0.0, 0.0, PI],
        [0.0, 0.0, FRAC_PI_2],
        [-FRAC_PI_2, 0.0, 0.0],
        [0.3, -0.4, 2.0],
        [-2.5, 1.0, -0.7],
    ] {
        let faults = find_faults(&[in_rotated_box("a", angles), in_rotated_box("b", angles)]);
        let runs: Vec<&str> = faults.iter().map(|fault| fault.run.as_str()).collect();
        assert_eq!(runs, ["a", "b"], "{angles:?}: {faults:#?}");
        for fault in &faults {
            assert!(
                fault.proven && fault.kind == FaultKind::Rotation,
                "{fault:?}"
            );
            assert_eq!(fault.columns.len(), 6);
            let list = fault.mend.split(['[', ']']).nth(1).unwrap();
            let found = list.split(", ").map(|angle| angle.parse::<f64>().unwrap());
            for (found, exact) in found.zip(angles) {
                let off = (found - exact + PI).rem_euclid(2.0 * PI) - PI;
                assert!(off.abs() < 0.01, "{angles:?}: {list}");
            }
        }
    }
    // A rotation near a quarter turn is reported as a quarter turn.
    let turned = find_faults(&[
        in_rotated_box("a", [0.0, 0.0, FRAC_PI_2]),
        in_rotated_box("b", [0.0, 0.0, FRAC_PI_2]),
    ]);
    assert!(
        turned[0]
            .mend
            .starts_with("rotation = [0.0000, 0.0000, 1.5708] in"),
        "{}",
        turned[0].mend
    );
    // For a box that is nearly aligned the finding is a note.
    let slight = find_faults(&[
        in_rotated_box("a", [0.0, 0.1, 0.0]),
        in_rotated_box("b", [0.0, 0.1, 0.0]),
    ]);
    assert!(slight.iter().all(|fault| !fault.proven), "{slight:?}");
    assert_eq!(slight[0].kind, FaultKind::Rotation);
    assert!(
        find_faults(&[
            in_rotated_box("a", [0.0, 0.0, 0.005]),
            in_rotated_box("b", [0.0; 3])
        ])
        .is_empty()
    );
    // The usual mounting accuracy is no inverted sign of a channel.
    for pitch in [-0.045, -0.03, 0.03, 0.045] {
        let mounted = ["a", "b"].map(|name| in_rotated_box(name, [0.0, pitch, 0.0]));
        assert_eq!(find_faults(&mounted), [], "{pitch}");
    }
}

/// The run under another name with its yaw rate multiplied by `sign`.
fn with_yaw_sign(name: &str, sign: f64) -> Run {
    let mut run = clean();
    run.entry.run = name.to_owned();
    let yaw = run.columns.get_mut("yaw_rate_radps").unwrap();
    yaw.iter_mut().for_each(|x| *x *= sign);
    run
}

#[test]
fn a_sign_fault_is_proven_only_if_all_runs_agree() {
    let mut mixed = [with_yaw_sign("a", 1.0), with_yaw_sign("b", -1.0)];
    let faults = find_faults(&mixed);
    assert!(
        faults
            .iter()
            .any(|f| f.run == "b" && f.kind == FaultKind::Sign)
    );
    assert!(
        faults.iter().all(|f| f.run == "b" && !f.proven),
        "{faults:?}"
    );
    check_relations(&mut mixed).unwrap();
    assert!(mixed[0].remarks.is_empty());
    assert!(
        mixed[1].remarks[0].contains("yaw_rate_radps"),
        "{:?}",
        mixed[1].remarks
    );
    let mut all = [with_yaw_sign("a", -1.0), with_yaw_sign("b", -1.0)];
    let proven = find_faults(&all).iter().filter(|f| f.proven).count();
    assert_eq!(proven, 2);
    let message = check_relations(&mut all).unwrap_err().to_string();
    assert!(message.contains("yaw_rate_radps"), "{message}");
}

#[test]
fn a_speed_in_a_wrong_unit_is_proven_with_its_unit() {
    for (factor, unit) in [
        (1.609_344, "\"km/h\""),
        (1.852, "\"km/h\""),
        (1.0 / 1.609_344, "\"mph\""),
        (1.0 / 1.852, "\"kn\""),
    ] {
        let faults = changed("v_mps", |_, v| factor * v).faults;
        assert_eq!(faults.len(), 1, "{factor}: {faults:#?}");
        let fault = &faults[0];
        assert!(fault.proven && fault.columns == ["v_mps"], "{fault:?}");
        assert!(fault.mend.contains(unit), "{factor}: {}", fault.mend);
    }
}

#[test]
fn a_correction_is_not_proven_if_a_relation_fails() {
    // 2.5 is no unit factor. In miles per hour the lateral relation is satisfied, the longitudinal
    // one is not.
    let faults = changed("v_mps", |_, v| 2.5 * v).faults;
    assert!(!faults.is_empty());
    assert!(faults.iter().all(|fault| !fault.proven), "{faults:#?}");
}

#[test]
fn a_box_pitched_by_two_degrees_has_no_delays() {
    let (sine, cosine) = 2_f64.to_radians().sin_cos();
    let mut run = clean();
    for [along, up] in [
        ["ax_mps2", "az_mps2"],
        ["roll_rate_radps", "yaw_rate_radps"],
    ] {
        let (x, z) = (run.columns[along].clone(), run.columns[up].clone());
        let pairs = || x.iter().zip(&z);
        let turned: Vec<f64> = pairs().map(|(x, z)| cosine * x - sine * z).collect();
        run.columns.insert(along.to_owned(), turned);
        let turned = pairs().map(|(x, z)| sine * x + cosine * z).collect();
        run.columns.insert(up.to_owned(), turned);
    }
    let pitched = examine_lines(&run, |lines| lines);
    let mut later = pitched
        .notes
        .iter()
        .filter(|note| note.what.contains("later"));
    assert!(later.next().is_none(), "{:?}", pitched.notes);
}

#[test]
fn a_speed_off_by_six_per_cent_differs_from_the_distance() {
    let fast = changed("v_mps", |_, v| 1.06 * v);
    assert!(notes(&fast, "v_mps").contains("+6.0 %"), "{:?}", fast.notes);
}
