//! Mappings guessed from samples, answered and used.

use std::path::PathBuf;

use kufe_telemetry::{Channel, Log, Mapping, TextOptions, guess_mapping, read_text};

use crate::truth::{column, import};

/// Rows of the truth under names and units that a maker might give them.
fn written(columns: &[(&str, &str, f64)], separator: char, decimal: char, rate: f64) -> String {
    let names: Vec<&str> = columns.iter().map(|(name, ..)| *name).collect();
    let mut text = names.join(&separator.to_string()) + "\n";
    for row in 0..(rate * 20.0) as usize {
        let t = row as f64 / rate;
        let cells = columns.iter().map(|(_, of, factor)| match *of {
            "t" => format!("{:.6}", t * factor),
            of => format!("{:.9}", column(of, t) * factor),
        });
        let cells: Vec<String> = cells
            .map(|cell| cell.replace('.', &decimal.to_string()))
            .collect();
        text += &(cells.join(&separator.to_string()) + "\n");
    }
    text
}

/// Answers every question: the line below it, its `#` taken away, `?` replaced.
fn answered(text: &str, answers: &[(&str, &str)]) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut question: Option<String> = None;
    for line in text.lines() {
        match question.take() {
            Some(question) => {
                let (_, answer) = answers
                    .iter()
                    .find(|(about, _)| question.starts_with(&format!("# ? {about}")))
                    .unwrap_or_else(|| panic!("no answer to {question}"));
                let bare = line.strip_prefix("# ").expect("a line to answer");
                lines.push(
                    bare.replace("\"?\"", &format!("{answer:?}"))
                        .replace("\"\"", &format!("{answer:?}")),
                );
            }
            None if line.starts_with("# ? ") => question = Some(line.to_string()),
            None => lines.push(line.to_string()),
        }
    }
    lines.join("\n")
}

const G: f64 = 1.0 / 9.806_65;
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

const INDEX: [(&str, &str); 7] = [
    ("track of", "west"),
    ("driver of", "a"),
    ("driver_class of", "x"),
    ("session of", "1"),
    ("ice_c of", ""),
    ("air_c of", ""),
    ("air_pa of", ""),
];

#[test]
fn what_is_guessed_of_two_loggers_is_imported_once_its_questions_are_answered() {
    let imu = written(
        &[
            ("Zeit", "t", 1e3),
            ("Längsbeschleunigung", "ax_mps2", G),
            ("Querbeschleunigung", "ay_mps2", G),
            ("Vertical Acc", "az_mps2", -G),
            ("Gyro Roll", "roll_rate_radps", DEGREES),
            ("Gyro Pitch", "pitch_rate_radps", DEGREES),
            ("Gyro Yaw", "yaw_rate_radps", DEGREES),
            ("Lenkwinkel [°]", "delta_rad", DEGREES),
            ("Schwimmwinkel", "alpha_rad", 1.0),
            ("Bremsdruck [bar]", "gamma_rad", 1.0),
        ],
        ';',
        ',',
        500.0,
    );
    let gps = written(
        &[
            ("Timestamp", "t", 1.0),
            ("GPS Speed", "v_mps", 3.6),
            ("YawRate [deg/s]", "yaw_rate_radps", DEGREES),
        ],
        ',',
        '.',
        20.0,
    );
    let log = |text: &str, name: &str| {
        read_text(
            text.as_bytes(),
            TextOptions::default(),
            None,
            u64::MAX,
            name,
        )
        .unwrap()
    };
    let samples = [
        (PathBuf::from("raw/imu_r1.csv"), log(&imu, "imu")),
        (PathBuf::from("raw/gps_r1.csv"), log(&gps, "gps")),
    ];
    let text = guess_mapping(&samples);
    for line in [
        "clock = \"imu\"",
        "files = \"raw/imu_*.csv\"",
        "time_unit = \"ms\"",
        "az_mps2 = { logger = \"imu\", from = \"Vertical Acc\", unit = \"g\", sign = -1 }      # likely: by its name; median -0.9",
        "ay_mps2 = { logger = \"imu\", from = \"Querbeschleunigung\", unit = \"g\" }      # likely: by its name; g as \"Vertical Acc\"",
        "v_mps = { logger = \"gps\", from = \"GPS Speed\", unit = \"km/h\" }      # likely: by its name; largest magnitude 10",
        "delta_rad = { logger = \"imu\", from = \"Lenkwinkel\" }      # likely: by its name; the file says °",
        "also.yaw_rate_radps = { from = \"YawRate\" }",
        "# ? gamma_rad: no channel of that name",
        "# ? alpha_rad: is \"Schwimmwinkel\" in rad or deg? largest magnitude 0.02",
        "# ? track of the runs",
        "# Not used: \"Bremsdruck\"",
    ] {
        assert!(text.contains(line), "{line:?} is not in:\n{text}");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("raw")).unwrap();
    std::fs::write(folder.path().join("raw/imu_r1.csv"), imu).unwrap();
    std::fs::write(folder.path().join("raw/gps_r1.csv"), gps).unwrap();
    // No sensor of gamma: its question is taken out.
    let questions: Vec<&str> = text
        .lines()
        .filter(|line| !line.contains("gamma_rad"))
        .collect();
    let mut answers = vec![("alpha_rad", "rad")];
    answers.extend(INDEX);
    let mapping = answered(&questions.join("\n"), &answers);
    let imported = import(folder.path(), &mapping).unwrap();
    let (run, note) = (&imported[0].run, &imported[0].note);
    assert_eq!(note.run, "r1");
    assert_eq!(note.loggers["gps"].clock.source, "found");
    for name in [
        "ax_mps2",
        "ay_mps2",
        "az_mps2",
        "yaw_rate_radps",
        "v_mps",
        "delta_rad",
        "alpha_rad",
    ] {
        let values = run.column(name).unwrap();
        for row in (200..1700).step_by(50) {
            let exact = column(name, note.start_s + row as f64 * 0.01);
            // The delay is found within a millisecond.
            assert!(
                (values[row] - exact).abs() < 0.02 * exact.abs().max(0.05),
                "{name}, row {row}: {} for {exact}",
                values[row]
            );
        }
    }
}

#[test]
fn kufes_own_files_ask_for_no_more_than_the_index() {
    let own: Vec<(&str, &str, f64)> = std::iter::once(("t_s", "t", 1.0))
        .chain(crate::truth::COLUMNS.map(|name| (name, name, 1.0)))
        .collect();
    let text = written(&own, ',', '.', 100.0);
    let log = read_text(
        text.as_bytes(),
        TextOptions::default(),
        None,
        u64::MAX,
        "r.csv",
    )
    .unwrap();
    let guessed = guess_mapping(&[(PathBuf::from("r.csv"), log)]);
    assert_eq!(
        guessed.matches("sure: the name is kufe's own").count(),
        10,
        "{guessed}"
    );
    assert_eq!(guessed.matches("\n# ? ").count(), 7, "{guessed}");
    Mapping::parse(&answered(&guessed, &INDEX), "mapping.toml").unwrap();
}

#[test]
fn a_box_upside_down_is_turned_as_a_whole() {
    let down = ["ay_mps2", "az_mps2", "pitch_rate_radps", "yaw_rate_radps"];
    let own: Vec<(&str, &str, f64)> = std::iter::once(("t_s", "t", 1.0))
        .chain(crate::truth::COLUMNS.map(|name| {
            let sign = if down.contains(&name) { -1.0 } else { 1.0 };
            (name, name, sign)
        }))
        .collect();
    let text = written(&own, ',', '.', 100.0);
    let options = TextOptions::default();
    let log = read_text(text.as_bytes(), options, None, u64::MAX, "r.csv").unwrap();
    let guessed = guess_mapping(&[(PathBuf::from("raw/r.csv"), log)]);
    assert!(!guessed.contains("sign = -1"), "{guessed}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("raw")).unwrap();
    std::fs::write(folder.path().join("raw/r.csv"), text).unwrap();
    let imported = import(folder.path(), &answered(&guessed, &INDEX)).unwrap();
    for name in down {
        for (row, value) in imported[0].run.column(name).unwrap().iter().enumerate() {
            let exact = column(name, row as f64 * 0.01);
            assert!((value - exact).abs() < 1e-8, "{name}, row {row}: {value}");
        }
    }
}

#[test]
fn files_of_one_name_in_two_folders_are_two_loggers() {
    let log = |text: &str| {
        read_text(text.as_bytes(), TextOptions::default(), None, u64::MAX, "a").unwrap()
    };
    let rows = |names: &str, count: i32| -> String {
        let row = |i: i32| format!("{},{0},{0}\n", f64::from(i) * 2.0 / f64::from(count));
        format!("{names}\n{}", (0..count).map(row).collect::<String>())
    };
    let imu = rows("UTC Time,accel_x_gs,yaw_rate_deg_per_s", 100);
    let gps = rows("t_s,speed_meters_per_s,yaw_rate", 20);
    let files = [
        (PathBuf::from("imu/run1.csv"), log(&imu)),
        (PathBuf::from("gps/run1.csv"), log(&gps)),
    ];
    let text = guess_mapping(&files);
    for line in [
        "[logger.imu]\nfiles = \"imu/*.csv\"",
        "[logger.gps]\nfiles = \"gps/*.csv\"",
        "time = \"UTC Time\"",
        "ax_mps2 = { logger = \"imu\", from = \"accel_x_gs\" }      # likely: by its name; the file says gs",
        "v_mps = { logger = \"gps\", from = \"speed_meters_per_s\" }",
        "yaw_rate_radps = { logger = \"imu\", from = \"yaw_rate_deg_per_s\" }",
        // Of no use but to find the delay.
        "also.yaw_rate_radps = { from = \"yaw_rate\", unit = ",
    ] {
        assert!(text.contains(line), "{line:?} is not in:\n{text}");
    }
    Mapping::parse(&text, "mapping.toml").unwrap();
}

#[test]
fn the_run_is_the_longest_part_of_the_names_that_cuts_no_word() {
    let rows: String = (0..50).map(|i| format!("{i},{i}\n")).collect();
    let text = format!("t_s,v_mps\n{rows}");
    let log = || read_text(text.as_bytes(), TextOptions::default(), None, u64::MAX, "a").unwrap();
    let cases: [(&[&str], &str, &[&str]); 5] = [
        // The name of one file is the run's name alone.
        (
            &["imu_Ann_01.csv", "optik_Ann_01.txt", "Ann_01.mf4"],
            "Ann_01",
            &["imu_*.csv", "optik_*.txt", "*.mf4"],
        ),
        (
            &["sled_01.csv", "imu_21.csv"],
            "",
            &["sled_01.csv", "imu_21.csv"],
        ),
        (
            &["run7-gps.csv", "run7-gyro.csv"],
            "run7",
            &["*-gps.csv", "*-gyro.csv"],
        ),
        (
            &["gpsRun3.csv", "imuRun3.csv"],
            "Run3",
            &["gps*.csv", "imu*.csv"],
        ),
        (&["gps12.csv", "imu12.csv"], "12", &["gps*.csv", "imu*.csv"]),
    ];
    for (names, run, patterns) in cases {
        let files: Vec<(PathBuf, Log)> = names.iter().map(|name| (name.into(), log())).collect();
        let text = guess_mapping(&files);
        for pattern in patterns {
            let line =
                format!("files = {pattern:?}      # the * is the run's name, here {run:?}\n");
            assert!(text.contains(&line), "{line:?} is not in:\n{text}");
        }
    }
}

#[test]
fn the_faster_and_unsmoothed_channel_is_taken() {
    let mut text = String::from("t_s,GPS Lateral Acc [g],Acc Y [g],Lat Acc filtered [g]\n");
    for i in 0..400 {
        let noise = if i % 2 == 0 { 0.01 } else { -0.01 };
        let y = (f64::from(i) * 0.02).sin();
        let slow = if i % 5 == 0 {
            format!("{y:.4}")
        } else {
            String::new()
        };
        text += &format!(
            "{:.2},{slow},{:.4},{y:.4}\n",
            f64::from(i) * 0.01,
            y + noise
        );
    }
    let log = read_text(text.as_bytes(), TextOptions::default(), None, u64::MAX, "a").unwrap();
    let guessed = guess_mapping(&[(PathBuf::from("a.csv"), log)]);
    assert!(
        guessed.contains("ay_mps2 = { from = \"Acc Y\" }"),
        "{guessed}"
    );
}

#[test]
fn the_axes_of_one_accelerometer_are_taken_together() {
    let text = "time,lateral_acc,longitudinal_acc,x_acc,y_acc,z_acc\ns,G,G,G,G,G\n";
    let row = |i: i32| {
        let wave = (f64::from(i) * 0.1).sin();
        format!(
            "{:.2},{wave:.4},{wave:.4},{wave:.4},{:.4},{:.4}\n",
            0.02 * f64::from(i),
            -wave,
            -1.0
        )
    };
    let text = text.to_string() + &(0..200).map(row).collect::<String>();
    let log = read_text(text.as_bytes(), TextOptions::default(), None, u64::MAX, "a").unwrap();
    let guessed = guess_mapping(&[(PathBuf::from("a.csv"), log)]);
    for line in [
        "ax_mps2 = { from = \"x_acc\" }",
        "ay_mps2 = { from = \"y_acc\" }",
        "\"lateral_acc\"",
    ] {
        assert!(guessed.contains(line), "{line:?} is not in:\n{guessed}");
    }
}

#[test]
fn a_file_with_clocks_of_its_own_needs_no_time_channel() {
    let channel = |name: &str, unit: &str, clock: usize, rows: usize| Channel {
        name: name.to_string(),
        unit: Some(unit.to_string()),
        clock: Some(clock),
        values: (0..rows).map(|i| i as f64 / rows as f64).collect(),
    };
    let log = Log {
        channels: vec![
            channel("time (group 0)", "s", 0, 20),
            channel("Speed", "km/h", 0, 20),
            channel("time (group 1)", "s", 1, 200),
            channel("LatAcc", "g", 1, 200),
        ],
        clocks: [20, 200]
            .map(|rows| (0..rows).map(f64::from).collect())
            .into(),
        ..Log::default()
    };
    let guessed = guess_mapping(&[(PathBuf::from("a.mf4"), log)]);
    assert!(!guessed.contains("\ntime = "), "{guessed}");
    assert!(
        guessed.contains("v_mps = { from = \"Speed\" }"),
        "{guessed}"
    );
}

#[test]
fn fields_of_a_matlab_structure_are_known_by_their_own_names() {
    let rows: String = (0..50)
        .map(|i| format!("{},0.1,1.0\n", 10_000_000 * i))
        .collect();
    let text = format!("log.time,log.ax_g,log.az_g\n{rows}");
    let log = read_text(text.as_bytes(), TextOptions::default(), None, u64::MAX, "a").unwrap();
    let guessed = guess_mapping(&[(PathBuf::from("a.csv"), log)]);
    for line in [
        "time = \"log.time\"          # usual step 10000000: 100 Hz\ntime_unit = \"ns\"",
        "ax_mps2 = { from = \"log.ax_g\" }",
        "az_mps2 = { from = \"log.az_g\" }",
    ] {
        assert!(guessed.contains(line), "{line:?} is not in:\n{guessed}");
    }
}
