//! Faulty files are refused with the file, the place, the value found and the value expected.

use std::path::{Path, PathBuf};

use kufe_sled::{
    COLUMNS, Error, Needs, OnGaps, Track, read_good_runs, read_index, read_run, read_runs,
};

/// Writes a plausible run of `samples` samples at 100 Hz; `spoil` may change any cell of it.
fn run_file(folder: &Path, name: &str, samples: usize, spoil: &dyn Fn(usize, &str, f64) -> String) {
    let mut text = format!("t_s,{}\n", COLUMNS.join(","));
    for i in 0..samples {
        let t = i as f64 * 0.01;
        let wave = (3.0 * t).sin();
        let shift = name.len() as f64 * 1e-3;
        let values = [
            -0.3 - 0.01 * wave,
            0.5 * wave + shift,
            9.7 + 5.0 * wave * wave,
            0.2 * wave,
            -0.3 * wave * wave,
            0.1 * wave,
            20.0 + 0.1 * t,
            0.01 * wave,
            0.02 * wave,
            0.01 * wave,
        ];
        let mut cells = vec![spoil(i, "t_s", t)];
        for (column, value) in COLUMNS.iter().zip(values) {
            cells.push(spoil(i, column, value));
        }
        text += &cells.join(",");
        text.push('\n');
    }
    std::fs::write(folder.join(format!("{name}.csv")), text).unwrap();
}

fn plain(_: usize, _: &str, value: f64) -> String {
    value.to_string()
}

fn index(folder: &Path, rows: &[(&str, &str)]) -> PathBuf {
    let mut text = String::from("run,file,track,driver,driver_class,session,ice_c,air_c,air_pa\n");
    for (run, file) in rows {
        text += &format!("{run},{file},east,A1,A,d1,-8,-2,95000\n");
    }
    let path = folder.join("runs.csv");
    std::fs::write(&path, text).unwrap();
    path
}

/// The error message for a spoilt run.
fn reported(samples: usize, spoil: &dyn Fn(usize, &str, f64) -> String) -> String {
    let folder = tempfile::tempdir().unwrap();
    run_file(folder.path(), "bad", samples, spoil);
    let index = index(folder.path(), &[("K1", "bad.csv")]);
    match read_runs(&index, &Needs::FORCES, OnGaps::Refuse) {
        Ok(_) => panic!("accepted"),
        Err(error) => error.to_string(),
    }
}

fn has(message: &str, parts: &[&str]) {
    println!("{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in: {message}");
    }
    assert_eq!(message.lines().count(), 1);
}

#[test]
fn a_valid_file_is_accepted_and_extra_columns_are_retained() {
    let folder = tempfile::tempdir().unwrap();
    run_file(folder.path(), "good", 200, &plain);
    let path = folder.path().join("good.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let with: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(i, line)| {
            if i == 0 {
                format!("{line},lap,mood")
            } else {
                format!("{line},{i},fine")
            }
        })
        .collect();
    std::fs::write(&path, with.join("\n") + "\n").unwrap();
    let runs = read_runs(
        &index(folder.path(), &[("K1", "good.csv")]),
        &Needs::FORCES,
        OnGaps::LeaveOut,
    )
    .unwrap();
    assert_eq!(runs[0].len(), 200);
    assert!((runs[0].rate_hz() - 100.0).abs() < 1e-6);
    assert_eq!(runs[0].column("lap").unwrap()[3], 4.0);
    assert!(runs[0].column("mood").is_err());
}

#[test]
fn a_missing_column_is_reported_with_the_present_ones() {
    let folder = tempfile::tempdir().unwrap();
    run_file(folder.path(), "bad", 200, &plain);
    let path = folder.path().join("bad.csv");
    let text = std::fs::read_to_string(&path)
        .unwrap()
        .replace("gamma_rad", "gamma");
    std::fs::write(&path, text).unwrap();
    let error = read_runs(
        &index(folder.path(), &[("K1", "bad.csv")]),
        &Needs::FORCES,
        OnGaps::LeaveOut,
    )
    .unwrap_err();
    has(
        &error.to_string(),
        &["bad.csv", "gamma_rad is missing", "delta_rad"],
    );
}

#[test]
fn wrong_units_are_detected_by_their_range() {
    for (column, factor, parts) in [
        (
            "alpha_rad",
            180.0 / std::f64::consts::PI,
            ["alpha_rad", "degrees", "radians"],
        ),
        (
            "delta_rad",
            180.0 / std::f64::consts::PI,
            ["delta_rad", "degrees", "radians"],
        ),
        (
            "pitch_rate_radps",
            180.0 / std::f64::consts::PI,
            ["pitch_rate_radps", "degrees per second", "radians"],
        ),
        ("az_mps2", 1.0 / 9.81, ["az_mps2", "multiples of g", "9.81"]),
        ("v_mps", 3.6, ["v_mps", "km/h", "metres per second"]),
    ] {
        let message = reported(400, &|_, name, value| {
            (if name == column {
                factor * value
            } else {
                value
            })
            .to_string()
        });
        has(&message, &["bad.csv"]);
        has(&message, &parts);
    }
}

#[test]
fn irregular_time_and_clock_jumps_are_reported_with_their_row() {
    let message = reported(200, &|i, name, value| {
        (if name == "t_s" && i == 57 {
            value + 0.002
        } else {
            value
        })
        .to_string()
    });
    has(&message, &["row 59", "irregular time", "0.012", "0.010000"]);
    let message = reported(200, &|i, name, value| {
        (if name == "t_s" && i >= 100 {
            value + 5.0
        } else {
            value
        })
        .to_string()
    });
    has(&message, &["row 102", "clock jump", "5.01"]);
    let message = reported(200, &|i, name, value| {
        (if name == "t_s" && i >= 100 {
            value - 0.5
        } else {
            value
        })
        .to_string()
    });
    has(&message, &["row 102", "backwards"]);
}

#[test]
fn row_numbers_count_blank_lines() {
    for (column, faulty, parts) in [
        ("t_s", "0.5", ["row 104", "backwards"]),
        ("v_mps", "", ["row 104", "missing"]),
        ("v_mps", "0", ["row 104", "standstill"]),
        ("v_mps", "1e7", ["row 104", "between"]),
    ] {
        let message = reported(200, &|i, name, value| match (i, name) {
            (5, "t_s") => format!("\n\n{value}"),
            (100, name) if name == column => faulty.to_string(),
            _ => value.to_string(),
        });
        has(&message, &parts);
    }
    // A row without a time counts as a line.
    let folder = tempfile::tempdir().unwrap();
    run_file(
        folder.path(),
        "bad",
        200,
        &|i, name, value| match (i, name) {
            (5, "t_s") => String::new(),
            (100, "t_s") => "0.5".to_string(),
            _ => value.to_string(),
        },
    );
    let path = index(folder.path(), &[("K1", "bad.csv")]);
    let entry = read_index(&path).unwrap().remove(0);
    let error = read_run(entry, &COLUMNS, OnGaps::LeaveOut).unwrap_err();
    has(&error.to_string(), &["row 102", "backwards"]);
    let text = "s_m,slope_rad,curvature_1pm,bank_rad\n0,0,0,0\n\n\n10,0,0,0\n5,0,0,0\n20,0,0,0\n";
    let error = Track::from_csv(text.as_bytes(), "east", "track_east.csv").unwrap_err();
    has(&error.to_string(), &["row 6", "s_m"]);
}

#[test]
fn bursts_of_nan_are_reported_and_never_filled() {
    let message = reported(300, &|i, name, value| {
        let missing = name == "az_mps2" && ((40..75).contains(&i) || i == 200);
        if missing {
            "NaN".to_string()
        } else {
            value.to_string()
        }
    });
    has(
        &message,
        &[
            "az_mps2",
            "35 values",
            "row 42",
            "0.400 s",
            "2 such bursts",
            "36 values",
        ],
    );
    let message = reported(300, &|i, name, value| {
        if name == "v_mps" && i == 3 {
            String::new()
        } else {
            value.to_string()
        }
    });
    has(&message, &["v_mps", "1 values", "row 5"]);
    let message = reported(300, &|i, name, value| {
        if name == "v_mps" && i == 3 {
            "fast".to_string()
        } else {
            value.to_string()
        }
    });
    has(&message, &["v_mps", "row 5", "\"fast\"", "a number"]);
}

#[test]
fn text_is_refused_except_for_words_that_mean_no_value() {
    let with = |word: &'static str| {
        move |i: usize, name: &str, value: f64| {
            if name == "gamma_rad" && i == 150 {
                word.to_string()
            } else {
                value.to_string()
            }
        }
    };
    let folder = tempfile::tempdir().unwrap();
    run_file(folder.path(), "bad", 300, &with("abc"));
    let path = index(folder.path(), &[("K1", "bad.csv")]);
    let entry = read_index(&path).unwrap().remove(0);
    // An optional column of a run.
    let error = read_run(entry.clone(), &["v_mps"], OnGaps::LeaveOut).unwrap_err();
    has(&error.to_string(), &["gamma_rad", "row 152", "\"abc\""]);
    for word in ["", "NA", "null", "nan"] {
        run_file(folder.path(), "bad", 300, &with(word));
        let run = read_run(entry.clone(), &COLUMNS, OnGaps::LeaveOut).unwrap();
        assert_eq!(run.gaps.missing["gamma_rad"], 1, "{word:?}");
    }
    run_file(folder.path(), "bad", 300, &|_, name, value| {
        if name == "gamma_rad" {
            String::new()
        } else {
            value.to_string()
        }
    });
    let run = read_run(entry.clone(), &["v_mps"], OnGaps::LeaveOut).unwrap();
    assert!(!run.columns.contains_key("gamma_rad") && run.gaps.is_none());
    has(&run.remarks[0], &["gamma_rad", "not recorded"]);
    let error = read_run(entry, &COLUMNS, OnGaps::LeaveOut).unwrap_err();
    has(&error.to_string(), &["gamma_rad", "300 values"]);
}

#[test]
fn runs_of_three_samples_or_at_standstill_are_refused() {
    has(&reported(3, &plain), &["samples: 3", "at least 64"]);
    let message = reported(200, &|i, name, value| {
        (if name == "v_mps" && i < 20 {
            0.0
        } else {
            value
        })
        .to_string()
    });
    has(&message, &["row 2", "v_mps = 0", "standstill"]);
}

#[test]
fn duplicate_runs_are_refused_and_can_be_excluded() {
    let folder = tempfile::tempdir().unwrap();
    run_file(folder.path(), "one", 200, &plain);
    run_file(folder.path(), "other", 200, &plain);
    std::fs::copy(
        folder.path().join("one.csv"),
        folder.path().join("copy.csv"),
    )
    .unwrap();
    let twice = index(folder.path(), &[("K1", "one.csv"), ("K1", "other.csv")]);
    has(
        &read_runs(&twice, &Needs::FORCES, OnGaps::LeaveOut)
            .unwrap_err()
            .to_string(),
        &["row 3", "\"K1\"", "row 2"],
    );
    let shared = index(folder.path(), &[("K1", "one.csv"), ("K2", "one.csv")]);
    has(
        &read_index(&shared).unwrap_err().to_string(),
        &["\"K1\"", "\"K2\"", "same samples"],
    );
    let names: Vec<String> = (0..30_000).map(|k| k.to_string()).collect();
    let many: Vec<(&str, &str)> = names.iter().map(|n| (n.as_str(), n.as_str())).collect();
    let many = index(folder.path(), &many);
    has(
        &read_index(&many).unwrap_err().to_string(),
        &["row 20002", "at most 20000 runs"],
    );
    let copied = index(
        folder.path(),
        &[("K1", "one.csv"), ("K2", "other.csv"), ("K3", "copy.csv")],
    );
    has(
        &read_runs(&copied, &Needs::FORCES, OnGaps::LeaveOut)
            .unwrap_err()
            .to_string(),
        &["\"K1\"", "\"K3\"", "same samples"],
    );
    let (good, bad) = read_good_runs(&copied, &Needs::FORCES, OnGaps::LeaveOut).unwrap();
    assert_eq!(good.len(), 2);
    assert!(matches!(bad[..], [Error::DuplicateContent { .. }]));
}

#[test]
fn an_index_with_other_columns_or_values_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.csv");
    let header = "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa";
    for (text, parts) in [
        (
            format!("{header},weather\nK1,a.csv,e,A1,A,d1,-8,-2,95000,dry\n"),
            ["weather", "unknown", "air_pa"],
        ),
        (
            "run,track\nK1,e\n".to_owned(),
            ["file is missing", "run, track", ""],
        ),
        (
            "run,file,ice_c@start\nK1,a.csv,-8\n".to_owned(),
            ["ice_c@start", "at no distance", "ice_c@350"],
        ),
        (
            "run,file,ice_c@100,ice_c@100.0\nK1,a.csv,-8,-7\n".to_owned(),
            ["ice_c@100.0", "given twice", ""],
        ),
        (
            "run,file,ice_c@100\nK1,a.csv,17\n".to_owned(),
            ["row 2", "ice_c@100", "from -60 to 5"],
        ),
        (
            format!("{header}\nK1,a.csv,e,A1,A,d1,-8,-2,950\n"),
            ["row 2", "air_pa", "50000"],
        ),
        (
            format!("{header}\nK1,a.csv,e,A1,A,d1,265,-2,95000\n"),
            ["row 2", "ice_c", "265"],
        ),
        (
            format!("{header}\n\nK1,absent.csv,e,A1,A,d1,-8,-2,95000\n"),
            ["runs.csv: row 3", "absent.csv", "No such file"],
        ),
    ] {
        std::fs::write(&path, text).unwrap();
        has(
            &read_runs(&path, &Needs::FORCES, OnGaps::LeaveOut)
                .unwrap_err()
                .to_string(),
            &parts,
        );
    }
}

#[test]
fn infinite_numbers_and_other_formats_are_refused_and_blank_lines_ignored() {
    let infinite = |i: usize, column: &str, value: f64| match (i, column) {
        (70, "ay_mps2") => "inf".to_string(),
        _ => value.to_string(),
    };
    has(&reported(200, &infinite), &["row 72", "ay_mps2", "inf"]);
    let folder = tempfile::tempdir().unwrap();
    run_file(folder.path(), "bad", 200, &plain);
    let index = index(folder.path(), &[("K1", "bad.csv")]);
    let path = folder.path().join("bad.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let read = read_runs(&index, &Needs::FORCES, OnGaps::Refuse);
        read.map(|runs| runs[0].len())
            .map_err(|error| error.to_string())
    };
    let semicolons = text.replace(',', ";");
    has(
        &read(semicolons.as_bytes()).unwrap_err(),
        &["semicolons", "kufe runs import"],
    );
    let wide = |text: &str| {
        text.encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect::<Vec<u8>>()
    };
    for wide in [wide(&text), wide(&format!("\u{feff}{text}"))] {
        let error = read(&wide).unwrap_err();
        has(&error, &["bad.csv", "UTF-", "kufe runs import"]);
    }
    let named = std::fs::read_to_string(&index).unwrap();
    std::fs::write(&index, wide(&named)).unwrap();
    let error = read(text.as_bytes()).unwrap_err();
    let expected = "text in UTF-16; expected UTF-8 with commas between cells";
    has(&error, &["runs.csv: ", expected]);
    std::fs::write(&index, named).unwrap();
    let end = text.match_indices('\n').nth(50).unwrap().0;
    let with = |line: &str| format!("{}\n{line}{}", &text[..end], &text[end..]);
    assert_eq!(read(with("").as_bytes()), Ok(200));
    assert_eq!(read(with("  ").as_bytes()), Ok(200));
    has(
        &read(with("\0\0").as_bytes()).unwrap_err(),
        &["row 52", "1 cells", "expected 11"],
    );
}

#[test]
fn damaged_parquet_and_matlab_files_are_errors_without_panics() {
    let folder = tempfile::tempdir().unwrap();
    let mut whole = Vec::new();
    let values: Vec<f64> = (0..300).map(f64::from).collect();
    kufe_sled::write_parquet(&mut whole, &[("t_s", &values)]).unwrap();
    for name in ["cut.parquet", "flipped.parquet", "noise.mat", "empty.mat"] {
        let bytes = match name {
            "cut.parquet" => whole[..whole.len() / 2].to_vec(),
            "flipped.parquet" => whole
                .iter()
                .enumerate()
                .map(|(i, b)| if i % 7 == 5 { !b } else { *b })
                .collect(),
            "noise.mat" => (0..4096_u32)
                .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
                .collect(),
            _ => Vec::new(),
        };
        std::fs::write(folder.path().join(name), bytes).unwrap();
        let error = read_runs(
            &index(folder.path(), &[("K1", name)]),
            &Needs::FORCES,
            OnGaps::LeaveOut,
        )
        .unwrap_err();
        has(&error.to_string(), &[name]);
    }
}
