//! Numbers that no sled has, through every command that reads runs: an answer is finite, or an error names the place.

use std::path::Path;

use crate::kufe::{Bench, errors, names};

/// Entries of a folder's CSV and JSON files that are no finite numbers; NaN in a table is a gap.
fn not_finite(folder: &Path) -> Option<String> {
    names(folder).into_iter().find_map(|name| {
        let text = std::fs::read_to_string(folder.join(&name)).ok()?;
        // A replay that was not stopped; a mean over all tracks.
        let text = text
            .replace("\"stopped\": null", "")
            .replace("\"track\": null", "");
        let is_word = |word: &str| {
            let word = word.trim().trim_start_matches('-').to_ascii_lowercase();
            ["inf", "null"].contains(&&*word)
        };
        let read = name.ends_with(".csv") || name.ends_with(".json");
        let mut words = text.split([',', '\n', ':', '[', ']', '}']);
        let found = words.find(|word| read && is_word(word))?;
        Some(format!("{name}: {found}"))
    })
}

/// A folder with a model, a track and the beginnings of two runs of the sample data.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    let read = |name: &str| {
        let text = std::fs::read_to_string(bench.path(&format!("sample/{name}")));
        text.expect("a file of the sample data")
    };
    let first = |text: &str, lines: usize| -> String {
        text.lines()
            .take(lines)
            .map(|line| format!("{line}\n"))
            .collect()
    };
    std::fs::create_dir(bench.path("runs")).expect("a folder");
    for (name, lines) in [("runs.csv", 3), ("A1-01.csv", 8000), ("A1-02.csv", 8000)] {
        bench.write(&format!("runs/{name}"), first(&read(name), lines));
    }
    for name in ["runs/track_east.csv", "track_east.csv"] {
        bench.write(name, read("track_east.csv"));
    }
    bench.write("model.toml", read("model.toml"));
    bench
}

/// The table with another text in these rows of a column.
fn changed(table: &str, column: &str, rows: std::ops::Range<usize>, value: &str) -> String {
    let mut lines: Vec<String> = table.lines().map(str::to_owned).collect();
    let place = lines[0].split(',').position(|name| name == column);
    let place = place.unwrap_or_else(|| panic!("no {column} in {}", lines[0]));
    for row in rows {
        let mut cells: Vec<&str> = lines[row].split(',').collect();
        cells[place] = value;
        lines[row] = cells.join(",");
    }
    lines.join("\n") + "\n"
}

/// Runs a command that answers with finite numbers into its folder, or refuses with `place`.
fn finite_or_refused(bench: &Bench, words: &str, place: &str) -> bool {
    let words: Vec<&str> = words.split(' ').collect();
    let out = bench.path(words[words.len() - 1]);
    let output = bench.kufe(&words);
    let message = errors(&output);
    match output.status.code() {
        Some(0) => {
            assert_eq!(not_finite(&out), None, "{words:?}");
            std::fs::remove_dir_all(&out).expect("its output");
            true
        }
        Some(3) => {
            assert!(message.contains(place), "{words:?}: {message}");
            assert!(!out.exists(), "{words:?}");
            false
        }
        code => panic!("{words:?}: {code:?}: {message}"),
    }
}

#[test]
fn runs_with_numbers_that_no_sled_has_are_refused_with_their_place() {
    let bench = bench();
    let whole = std::fs::read_to_string(bench.path("runs/A1-01.csv")).expect("a run");
    let commands = [
        "runs align runs/runs.csv --model model.toml -o aligned",
        "evaluate runs/runs.csv --model model.toml -o evaluated",
        "validate runs/runs.csv --model model.toml -o validated",
        "fit lateral runs/runs.csv --model model.toml -o fitted",
        "simulate model.toml runs/track_east.csv --replay runs/runs.csv --run A1-01 -o replayed",
    ];
    let columns = [
        "v_mps",
        "alpha_rad",
        "ax_mps2",
        "yaw_rate_radps",
        "delta_rad",
    ];
    for column in columns.into_iter().chain(["s_m"]) {
        for (rows, value) in [(50..51, "1e308"), (100..200, "-1e154"), (30..31, "1e309")] {
            let text = changed(&whole, column, rows.clone(), value);
            bench.write("runs/A1-01.csv", text);
            let place = format!("row {}, column {column}", rows.start + 1);
            // A command that does not use the column answers.
            let refused = commands.map(|words| !finite_or_refused(&bench, words, &place));
            assert!(refused.contains(&true), "{column}: {value}");
        }
    }
    bench.write("runs/A1-01.csv", &whole);
    for words in commands {
        assert!(finite_or_refused(&bench, words, ""), "{words}");
    }
}

#[test]
fn simulations_of_extreme_models_and_tracks_are_finite_or_refused() {
    let bench = bench();
    let model = std::fs::read_to_string(bench.path("model.toml")).expect("a model");
    let track = std::fs::read_to_string(bench.path("track_east.csv")).expect("a track");
    let mut answered = 0;
    let mut simulated = |place: &str| {
        let words = "simulate odd.toml track_o.csv --most-s 5 --rate-hz 100 -o out";
        answered += u32::from(finite_or_refused(&bench, words, place));
    };
    bench.write("track_o.csv", &track);
    for key in [
        "mass_kg",
        "j_zz_kgm2",
        "l_f_m",
        "cda_m2",
        "accel_mps2",
        "k_n_per_rad",
    ] {
        for value in ["1e308", "1e154", "1e-308", "-1e308", "1e3"] {
            let line = model.lines().find(|line| line.starts_with(key));
            let line = line.unwrap_or_else(|| panic!("no {key}"));
            let odd = model.replacen(line, &format!("{key} = {value}"), 1);
            bench.write("odd.toml", odd);
            simulated("");
        }
    }
    bench.write("odd.toml", &model);
    for column in ["s_m", "slope_rad", "curvature_1pm", "bank_rad"] {
        for value in ["1e308", "1e154", "1e6", "-1e308"] {
            let odd = changed(&track, column, 20..21, value);
            bench.write("track_o.csv", odd);
            simulated("track_o.csv");
        }
    }
    assert!(answered > 0);
}

#[test]
fn units_that_overflow_are_refused_with_their_place() {
    for (column, unit, value) in [
        ("ax_mps2", "g", "1.7e308"),
        ("ay_mps2", "g", "-1e308"),
        ("yaw_rate_radps", "rpm", "1e310"),
        ("x_m", "km", "1e307"),
    ] {
        let bench = Bench::new();
        let mut log = format!("Time [s],Speed [km/h],Other [{unit}]\n");
        for k in 0..300 {
            let cell = if k == 200 { value } else { "1.5" };
            log += &format!("{:.2},{},{cell}\n", 0.01 * f64::from(k), 50 + k % 7);
        }
        bench.write("log_a.csv", log);
        bench.write(
            "mapping.toml",
            format!(
                "rate_hz = 100\n[logger.a]\nfiles = \"log*.csv\"\ntime = \"Time\"\n\
                 [channels]\nv_mps = {{ from = \"Speed\" }}\n{column} = {{ from = \"Other\" }}\n"
            ),
        );
        let output = bench.kufe(&["runs", "import", "mapping.toml", "-o", "out"]);
        let message = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{value} {unit}: {message}");
        assert!(message.contains("row 202"), "{value} {unit}: {message}");
    }
}

#[test]
fn a_recording_without_its_last_line_end_loses_its_last_row_with_a_warning() {
    let bench = bench();
    let whole = std::fs::read_to_string(bench.path("runs/A1-01.csv")).expect("a run");
    let rows = whole.lines().count() - 1;
    let align = "runs align runs/runs.csv --model model.toml -o aligned";
    let align: Vec<&str> = align.split(' ').collect();
    for cut in [1, 3, 30] {
        bench.write("runs/A1-01.csv", &whole[..whole.len() - cut]);
        let output = bench.kufe(&align);
        let message = errors(&output);
        assert!(output.status.success(), "{message}");
        let printed = "A1-01.csv: the last line has no end and is not read";
        assert!(message.contains(printed), "{cut}: {message}");
        let written = std::fs::read_to_string(bench.path("aligned/A1-01.csv")).expect("a run");
        assert_eq!(written.lines().count() - 1, rows - 1, "{cut}");
    }
}

#[test]
fn no_table_has_a_column_twice() {
    let bench = bench();
    bench.write("case.toml", crate::kufe::CASE);
    let rows = |head: &str, row: &str| format!("{head}\n{}", format!("{row}\n").repeat(40));
    bench.write("heights.csv", rows("x_m,y_m,z_m,z_m", "0,0,0,1e-5"));
    let surface = crate::kufe::CASE.replace("[track]", "surface = \"heights.csv\"\n[track]");
    bench.write("surface.toml", surface);
    bench.write(
        "experiments.csv",
        rows(
            "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,mu",
            "a,8e6,1e5,0.004,1e-4,0.005",
        ),
    );
    bench.write(
        "glides.csv",
        rows(
            "run,file,specimen,direction,mass_kg,cda_m2,air_c,air_pa,air_c",
            "1,1.csv,a,1,100,0.05,-2,95000,-3",
        ),
    );
    bench.write(
        "pressures.csv",
        rows(
            "case,fz_n,radius_m,p_max_pa,p_max_sd_pa,fz_n",
            "case.toml,1000,inf,1e8,1e6,900",
        ),
    );
    let twice = |path: &str, column: &str, value: &str| {
        let text = std::fs::read_to_string(bench.path(path)).expect("a table");
        let mut lines = text.lines();
        let head = lines.next().expect("a header");
        let rows: String = lines.map(|line| format!("{line},{value}\n")).collect();
        bench.write(path, format!("{head},{column}\n{rows}"));
    };
    std::fs::create_dir(bench.path("words")).expect("a folder");
    for name in ["runs.csv", "A1-01.csv", "A1-02.csv", "track_east.csv"] {
        std::fs::copy(
            bench.path("runs").join(name),
            bench.path("words").join(name),
        )
        .expect("a copy");
    }
    twice("words/A1-01.csv", "v_mps", "fast");
    twice("runs/A1-01.csv", "v_mps", "9.5");
    std::fs::create_dir(bench.path("index")).expect("a folder");
    std::fs::copy(bench.path("runs/runs.csv"), bench.path("index/runs.csv")).expect("a copy");
    twice("index/runs.csv", "session", "other");
    std::fs::copy(bench.path("track_east.csv"), bench.path("track_t.csv")).expect("a copy");
    twice("track_t.csv", "slope_rad", "0.2");
    for words in [
        "evaluate runs/runs.csv --model model.toml -o out",
        "evaluate words/runs.csv --model model.toml -o out",
        "evaluate index/runs.csv --model model.toml -o out",
        "runs gather index -o all.csv",
        "simulate model.toml track_t.csv -o out",
        "press surface.toml -o out",
        "friction fit experiments.csv -o out",
        "icehouse glides.csv -o out",
        "discover pressures.csv --model case.toml -o out",
        "discover experiments.csv --model model.toml -o out",
    ] {
        let output = bench.kufe(&words.split(' ').collect::<Vec<_>>());
        let message = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{words}: {message}");
        assert!(
            message.contains("twice") || message.contains("second time"),
            "{words}: {message}"
        );
    }
}
