//! `kufe runs init` and `kufe runs import`.

use kufe_sled::{COLUMNS, read_columns, read_index};

use crate::kufe::{Bench, errors, json};

/// Answers the questions about the index that a guessed mapping of kufe's own file leaves.
fn answered(text: &str) -> String {
    let mut text = text.to_string();
    for (line, answer) in [
        ("# track = \"\"", "track = \"west\""),
        ("# driver = \"\"", "driver = \"a\""),
        ("# driver_class = \"\"", "driver_class = \"elite\""),
        ("# session = \"\"", "session = \"d1\""),
        ("# ice_c = -8.0", "ice_c = -7.5"),
        ("# air_c = 0.0", "air_c = 1.0"),
        ("# air_pa = 95000.0", "air_pa = 94000.0"),
    ] {
        assert!(text.contains(line), "{line}: {text}");
        text = text.replace(line, answer);
    }
    text
}

/// A bench with two recordings of simulated runs in `raw`, and a mapping guessed from the first and answered.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.succeeds(&["init", "--kind", "model", "-q"]);
    bench.write("track.csv", "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.08,0,0\n200,0.09,0.01,0.2\n400,0.08,0,0\n600,0.07,0,0\n");
    bench.succeeds(&[
        "simulate",
        "model.toml",
        "track.csv",
        "-o",
        "raw",
        "--runs",
        "2",
        "--seed",
        "3",
        "-q",
    ]);
    let index = read_index(&bench.path("raw/runs.csv")).expect("an index");
    for (entry, name) in index.iter().zip(["monday_1.csv", "monday_2.csv"]) {
        std::fs::copy(&entry.file, bench.path(name)).expect("a run");
    }
    bench.succeeds(&["runs", "init", "monday_1.csv", "-q"]);
    let text = std::fs::read_to_string(bench.path("mapping.toml")).expect("a mapping");
    bench.write(
        "mapping.toml",
        answered(&text).replace("\"*.csv\"", "\"monday_*.csv\""),
    );
    bench
}

/// Temperatures of the ice at places, of all runs in the mapping and of one in its table, come into `runs.csv`.
#[test]
fn ice_at_places_is_written_through() {
    let bench = bench();
    let text = std::fs::read_to_string(bench.path("mapping.toml")).expect("a mapping");
    let stated = "[index]\ntable = \"index.csv\"\nice_c_at = { 350 = -8.25, 1100 = -9.0 }";
    bench.write("mapping.toml", text.replace("[index]", stated));
    bench.write("index.csv", "run;ice_c@350;ice_c@90\n2;-6,5;-5\n");
    bench.succeeds(&["runs", "import", "mapping.toml", "-o", "runs", "-q"]);
    let index = read_index(&bench.path("runs/runs.csv")).expect("an index");
    assert_eq!(
        index[0].ice_along.points(),
        [[350.0, -8.25], [1100.0, -9.0]]
    );
    assert_eq!(index[1].ice_along.points(), [[90.0, -5.0], [350.0, -6.5]]);
    for (place, value, named) in [("here", "-8", "here"), ("350", "30", "-60 to 5")] {
        let wrong = format!("[index]\nice_c_at = {{ {place} = {value} }}");
        bench.write("mapping.toml", text.replace("[index]", &wrong));
        let output = bench.kufe(&["runs", "import", "mapping.toml", "-o", "runs"]);
        let reported = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{reported}");
        assert!(
            reported.contains("index.ice_c_at") && reported.contains(named),
            "{reported}"
        );
    }
}

#[test]
fn kufes_own_runs_are_imported_as_they_are_and_evaluated() {
    let bench = bench();
    let printed = bench.succeeds(&["runs", "import", "mapping.toml", "-o", "runs"]);
    assert!(printed.starts_with("2 runs, "), "{printed}");
    let index = read_index(&bench.path("runs/runs.csv")).expect("an index");
    assert_eq!(index.len(), 2);
    assert_eq!(
        (index[0].run.as_str(), index[0].track.as_str()),
        ("1", "west")
    );
    assert_eq!(index[1].conditions.ice_c, -7.5);
    let (own, original) = (
        read_columns(&index[0].file, &COLUMNS),
        read_columns(&bench.path("monday_1.csv"), &COLUMNS),
    );
    let (own, original) = (
        own.expect("a run").columns,
        original.expect("a run").columns,
    );
    let rate = 1.0 / (original["t_s"][1] - original["t_s"][0]);
    for name in COLUMNS {
        // The way of the other commands from a run's rate to a lower one; both are written with nine decimals.
        let expected = kufe_sled::resample(&original[name], rate, 100.0);
        assert!(own[name].len().abs_diff(expected.len()) <= 1, "{name}");
        for (row, (value, exact)) in own[name].iter().zip(&expected).enumerate() {
            assert!(
                (value - exact).abs() < 2e-9,
                "{name}, row {row}: {value} for {exact}"
            );
        }
    }
    let note = json(&bench.path("runs/1.import.json"));
    assert_eq!(note["loggers"]["box"]["file"], "monday_1.csv");
    assert_eq!(note["channels"]["v_mps"]["unit"], "m/s");
    let listed = json(&bench.path("runs/import.json"));
    assert_eq!(listed["runs"].as_array().map(Vec::len), Some(2));
    bench.succeeds(&[
        "evaluate",
        "runs/runs.csv",
        "--model",
        "model.toml",
        "-o",
        "evaluation",
        "-q",
    ]);
}

#[test]
fn an_import_is_whole_or_absent_and_replaces_only_its_own() {
    let bench = bench();
    let refused = |words: &[&str], printed: &str| {
        let output = bench.kufe(words);
        assert_eq!(output.status.code(), Some(3), "{words:?}");
        let reported = errors(&output);
        assert!(reported.contains(printed), "{reported}");
    };
    // Over its inputs, and over an index that it did not write.
    std::fs::rename(bench.path("monday_2.csv"), bench.path("kept.csv")).expect("a file");
    refused(
        &["runs", "import", "mapping.toml", "-o", "raw"],
        "it contains results of kufe simulate",
    );
    std::fs::create_dir(bench.path("in")).expect("a folder");
    std::fs::rename(bench.path("kept.csv"), bench.path("in/2.csv")).expect("a file");
    std::fs::copy(bench.path("monday_1.csv"), bench.path("in/1.csv")).expect("a file");
    let text = std::fs::read_to_string(bench.path("mapping.toml")).expect("a mapping");
    bench.write(
        "mapping.toml",
        text.replace("\"monday_*.csv\"", "\"in/*.csv\""),
    );
    refused(
        &["runs", "import", "mapping.toml", "-o", "in"],
        "kufe runs import did not write it",
    );
    // A recording that is wrong in its last row leaves nothing.
    let good = std::fs::read_to_string(bench.path("in/2.csv")).expect("text");
    let last = good.lines().last().expect("a line");
    bench.write(
        "in/2.csv",
        good.replace(last, &last.replacen(|c: char| c.is_ascii_digit(), "x", 1)),
    );
    refused(
        &["runs", "import", "mapping.toml", "-o", "runs", "--strict"],
        "expected a number",
    );
    assert!(!bench.path("runs").exists());
    // Or is excluded with its reason.
    let output = bench.kufe(&["runs", "import", "mapping.toml", "-o", "runs"]);
    assert_eq!(output.status.code(), Some(5));
    assert!(errors(&output).contains("expected a number"));
    let listed = json(&bench.path("runs/import.json"));
    assert_eq!(listed["excluded"][0]["run"], "2");
    let samples = &listed["runs"][0]["samples"]["v_mps"];
    assert_eq!(samples["read"], samples["expected"]);
    let index = read_index(&bench.path("runs/runs.csv")).expect("an index");
    assert_eq!(index.len(), 1);
    bench.write("in/2.csv", &good);
    bench.succeeds(&["runs", "import", "mapping.toml", "-o", "runs", "-q"]);
    bench.write("runs/mine.txt", "mine");
    std::fs::remove_file(bench.path("in/2.csv")).expect("a file");
    bench.succeeds(&["runs", "import", "mapping.toml", "-o", "runs", "-q"]);
    let names: Vec<String> = {
        let entries = std::fs::read_dir(bench.path("runs")).expect("a folder");
        let mut names: Vec<String> = entries
            .map(|e| {
                e.expect("an entry")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names
    };
    assert_eq!(
        names,
        [
            ".kufe.json",
            "1.csv",
            "1.import.json",
            "import.json",
            "mine.txt",
            "runs.csv"
        ]
    );
    refused(
        &["runs", "init", "in/1.csv", "-o", "in/1.csv"],
        "this command reads it",
    );
    refused(&["runs", "init", "in/1.csv"], "exists already");
}
