//! One logger: units, signs, rates, gaps, and how they are reported.

use std::fmt::Write;

use kufe_telemetry::{Mapping, plan};

use crate::truth::{COLUMNS, column, import};

const MAPPING: &str = r#"
[logger.box]
files = "raw/*.csv"
time = "Zeit"
[channels]
ax_mps2 = { from = "Longitudinal Acc", unit = "g", place_m = [-0.35, 0.0, 0.12] }
ay_mps2 = { from = "Lateral Acc", unit = "g", sign = -1, zero = 2.0, scale = 0.5 }
az_mps2 = { from = "Vertical Acc" }
roll_rate_radps = { from = "Roll Rate", unit = "deg/s" }
pitch_rate_radps = { from = "Pitch Rate", unit = "deg/s" }
yaw_rate_radps = { from = "Gyro Yaw", unit = "deg/s" }
v_mps = { from = "GPS Speed", unit = "km/h" }
alpha_rad = { from = "Schwimmwinkel" }
delta_rad = { from = "Lenkwinkel", unit = "mrad", sign = -1 }
gamma_rad = { from = "Knick", delay_s = 0.25 }
track_c = { from = "Bahntemperatur" }
"#;

/// What the logger writes of the truth: German, at `rate_hz`, its head above.
fn recording(rate_hz: f64, seconds: f64, lost: impl Fn(f64) -> bool) -> String {
    let mut text = String::from(
        "Fahrt 7;Igls\n\nZeit;Longitudinal Acc;Lateral Acc;Vertical Acc;Roll Rate;Pitch Rate;Gyro Yaw;GPS Speed;Schwimmwinkel;Lenkwinkel;Knick;Bahntemperatur;Ort\nms;g;counts;g;°/s;°/s;°/s;km/h;rad;mrad;°;°F;-\n",
    );
    for row in 0..(rate_hz * seconds) as usize {
        let t = row as f64 / rate_hz;
        if lost(t) {
            continue;
        }
        let x = |name: &str| column(name, t);
        let g = 9.806_65;
        let cells = [
            t * 1e3,
            x("ax_mps2") / g,
            2.0 - x("ay_mps2") / g / 0.5,
            x("az_mps2") / g,
            x("roll_rate_radps").to_degrees(),
            x("pitch_rate_radps").to_degrees(),
            x("yaw_rate_radps").to_degrees(),
            x("v_mps") * 3.6,
            x("alpha_rad"),
            -1e3 * x("delta_rad"),
            column("gamma_rad", t - 0.25).to_degrees(),
            14.0,
        ];
        let cells: Vec<String> = cells
            .iter()
            .map(|c| format!("{c:.9}").replace('.', ","))
            .collect();
        writeln!(text, "{};hier", cells.join(";")).unwrap();
    }
    text
}

fn folder_with(recordings: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("raw")).unwrap();
    for (name, text) in recordings {
        std::fs::write(folder.path().join("raw").join(name), text).unwrap();
    }
    folder
}

#[test]
fn units_signs_zeros_and_delays_give_the_truth_back() {
    for (rate, filtered) in [(500.0, true), (100.0, false), (40.0, false)] {
        let folder = folder_with(&[("r7.csv", recording(rate, 20.0, |_| false))]);
        let imported = import(folder.path(), MAPPING).unwrap();
        assert_eq!(imported.len(), 1);
        let (run, note) = (&imported[0].run, &imported[0].note);
        assert_eq!((run.entry.run.as_str(), run.dt_s), ("r7", 0.01));
        for name in COLUMNS {
            let values = run.column(name).unwrap();
            let largest = (0..2000)
                .map(|i| column(name, f64::from(i) * 0.01).abs())
                .fold(0.0, f64::max);
            // At 40 Hz a wave of 1.3 Hz is met by its spline within (2 pi 1.3 / 40)^4 / 384 = 5e-6
            // of its size; the ends are natural.
            let inner = values.iter().enumerate().take(values.len() - 100).skip(100);
            for (row, value) in inner {
                let error = (value - column(name, note.start_s + row as f64 * 0.01)).abs();
                assert!(
                    error < 1e-5 * largest,
                    "{rate} Hz, {name}, row {row}: {error:.2e} of {largest}"
                );
            }
            let reported = &note.channels[name];
            assert!(
                (reported.rate_hz / rate - 1.0).abs() < 1e-9,
                "{name}: {}",
                reported.rate_hz
            );
            assert_eq!(reported.filter_hz, filtered.then_some(40.0));
        }
        assert!((run.column("track_c").unwrap()[500] + 10.0).abs() < 1e-9);
        assert_eq!(note.channels["az_mps2"].recipe.unit_from, "file");
        assert_eq!(note.channels["ay_mps2"].sign, -1.0);
        assert_eq!(note.channels["ax_mps2"].place_m, Some([-0.35, 0.0, 0.12]));
        assert_eq!(note.loggers["box"].sha256.len(), 64);
    }
}

#[test]
fn lost_rows_stay_lost_and_are_listed() {
    let lost = |t: f64| (4.0..4.5).contains(&t) || (t - 9.0).abs() < 1e-9;
    let folder = folder_with(&[("r7.csv", recording(100.0, 20.0, lost))]);
    let imported = import(folder.path(), MAPPING).unwrap();
    let values = imported[0].run.column("v_mps").unwrap();
    for (row, value) in values.iter().enumerate() {
        let t = imported[0].note.start_s + row as f64 * 0.01;
        assert_eq!(value.is_nan(), lost((t * 1e3).round() / 1e3), "{t}");
    }
    let reported = &imported[0].note.channels["v_mps"];
    assert_eq!((reported.missing_rows, reported.gap_count), (51, 2));
}

#[test]
fn what_is_wrong_is_one_line_with_its_place() {
    let good = recording(100.0, 2.0, |_| false);
    let reported = |mapping: &str, text: &str| {
        let folder = folder_with(&[("r7.csv", text.to_string())]);
        let error = import(folder.path(), mapping).unwrap_err();
        assert!(!error.contains('\n'), "{error}");
        error.replace(&format!("{}/", folder.path().display()), "")
    };
    assert!(
        reported(&MAPPING.replace("Knick", "Knack"), &good)
            .starts_with("raw/r7.csv: there is no channel \"Knack\", expected one of: Zeit, ")
    );
    assert_eq!(
        reported(
            &MAPPING.replace(
                "\"GPS Speed\", unit = \"km/h\"",
                "\"GPS Speed\", unit = \"kg\""
            ),
            &good
        ),
        "mapping.toml: channels.v_mps.unit: found kg, expected a unit that converts to m/s (\"kg\" is no unit that converts to m/s)"
    );
    let text = good.replacen("90,", "9o,", 1);
    assert!(
        reported(MAPPING, &text).contains("expected a number"),
        "{}",
        reported(MAPPING, &text)
    );
    let mut rows: Vec<&str> = good.lines().collect();
    rows.swap(50, 60);
    // Blank lines and comments count, which are no samples.
    let after_others = format!("\n# a note\n{}", rows[20]);
    rows[20] = &after_others;
    let backwards = reported(MAPPING, &rows.join("\n"));
    for part in ["in row 54, ", "expected times that do not run backwards"] {
        assert!(backwards.contains(part), "{backwards}");
    }
    assert!(
        reported(&MAPPING.replace("raw/*", "raw/x*"), &good)
            .contains("expected files of that pattern")
    );
    assert!(reported(&MAPPING.replace("[channels]", "[chanels]"), &good).contains("chanels"));
    assert_eq!(
        reported(&MAPPING.replace("time = \"Zeit\"", ""), &good),
        "raw/r7.csv: no channel is its time: expected logger.box.time, or logger.box.rate_hz, in the mapping"
    );
    assert!(
        reported(&MAPPING.replace("sign = -1 }", "sign = -2 }"), &good)
            .contains("expected 1 or -1")
    );
}

#[test]
fn the_axes_of_a_rotated_box_are_turned_together() {
    let [roll, pitch, yaw] = [3.0_f64, 0.2, -1.4];
    // From the sled's axes to the box's: the inverse rotations in inverse order.
    let turned = |[x, y, z]: [f64; 3]| {
        let (s, c) = yaw.sin_cos();
        let [x, y] = [c * x + s * y, -s * x + c * y];
        let (s, c) = pitch.sin_cos();
        let [x, z] = [c * x - s * z, s * x + c * z];
        let (s, c) = roll.sin_cos();
        [x, c * y + s * z, -s * y + c * z]
    };
    let mut text = COLUMNS[..6].join(",") + ",t\n";
    for row in 0..500 {
        let t = f64::from(row) * 0.01;
        let of = |names: &[&str]| turned([0, 1, 2].map(|i| column(names[i], t)));
        for x in of(&COLUMNS[..3]).into_iter().chain(of(&COLUMNS[3..6])) {
            write!(text, "{x:.12},").unwrap();
        }
        writeln!(text, "{t:.2}").unwrap();
    }
    let folder = folder_with(&[("r.csv", text)]);
    let mut mapping = format!(
        "[logger.box]\nfiles = \"raw/*.csv\"\ntime = \"t\"\nrotation = [{roll:?}, {pitch:?}, {yaw:?}]\n[channels]\n"
    );
    for name in &COLUMNS[..6] {
        writeln!(mapping, "{name} = {{ from = {name:?} }}").unwrap();
    }
    let imported = import(folder.path(), &mapping).unwrap();
    for name in &COLUMNS[..6] {
        for (row, value) in imported[0].run.column(name).unwrap().iter().enumerate() {
            let exact = column(name, row as f64 * 0.01);
            assert!(
                (value - exact).abs() < 1e-9,
                "{name}, row {row}: {value} for {exact}"
            );
        }
    }
    let note = &imported[0].note;
    assert_eq!(note.loggers["box"].rotation, Some([roll, pitch, yaw]));
    assert_eq!(note.channels["ax_mps2"].samples, 500);
    assert_eq!(note.channels["ax_mps2"].expected_samples, 500);
    let error = import(folder.path(), &mapping.replace("az_mps2 =", "up_mps2 =")).unwrap_err();
    assert!(
        error.contains("logger.box.rotation: found 2 of 3 axes, expected ax_mps2, ay_mps2, az_mps2 in this logger"),
        "{error}"
    );
}

#[test]
fn a_run_without_all_of_its_files_is_excluded_with_its_reason() {
    let names = ["a_1.csv", "a_2.csv", "b_1.csv"];
    let folder = folder_with(&names.map(|name| (name, String::new())));
    let text = "clock = \"a\"\n[logger.a]\nfiles = \"raw/a_*.csv\"\ntime = \"t\"\n[logger.b]\nfiles = \"raw/b_*.csv\"\n\
        time = \"t\"\n[channels]\nv_mps = { logger = \"a\", from = \"v\" }\n";
    let mapping = Mapping::parse(text, "mapping.toml").unwrap();
    let found = plan(&mapping, folder.path(), "mapping.toml").unwrap();
    assert_eq!((found.runs.len(), found.runs[0].name.as_str()), (1, "1"));
    assert_eq!(
        (found.excluded.len(), found.excluded[0].run.as_str()),
        (1, "2")
    );
    let reason = &found.excluded[0].reason;
    assert!(
        reason.contains("logger.b.files: found no file of run 2"),
        "{reason}"
    );
    std::fs::remove_file(folder.path().join("raw/a_1.csv")).unwrap();
    assert!(plan(&mapping, folder.path(), "mapping.toml").is_err());
}

#[test]
fn the_last_row_by_times_since_1970_is_kept() {
    let mapping = "[logger.box]\nfiles = \"raw/*.csv\"\ntime = \"t_s\"\n[channels]\nv_mps = { from = \"v_mps\" }\n";
    for rows in [4000, 4360, 5001] {
        let row = |i: i32| format!("{:.2},{i}\n", 1_795_861_320.0 + 0.01 * f64::from(i));
        let rows_of: String = (0..rows).map(row).collect();
        let folder = folder_with(&[("r.csv", format!("t_s,v_mps\n{rows_of}"))]);
        let imported = import(folder.path(), mapping).unwrap();
        let values = imported[0].run.column("v_mps").unwrap();
        assert_eq!(values.last(), Some(&f64::from(rows - 1)));
    }
}
