//! Every bad input leaves with its code, one clear line, and nothing behind.

use crate::kufe::{Bench, CASE, errors, names};
use kufe_outside::not_here;

/// Runs `kufe press case.toml -o out` on `text` and expects exit code 3 and one line with the word `expected`.
fn refused(bench: &Bench, text: &str, expected: &[&str]) {
    bench.write("case.toml", text);
    let before = bench.names();
    let output = bench.kufe(&["press", "case.toml", "-o", "out"]);
    let printed = errors(&output);
    let lines: Vec<&str> = printed
        .lines()
        .filter(|line| !line.contains("warning:"))
        .collect();
    assert_eq!(output.status.code(), Some(3), "{printed}");
    assert_eq!(lines.len(), 1, "one line: {printed}");
    for part in expected {
        assert!(printed.contains(part), "{part:?} is missing: {printed}");
    }
    assert!(output.stdout.is_empty());
    assert_eq!(bench.names(), before, "a file remains");
}

fn changed(from: &str, to: &str) -> String {
    assert!(CASE.contains(from), "{from} is not in the case");
    CASE.replacen(from, to, 1)
}

#[test]
fn a_case_that_does_not_exist_is_named() {
    let bench = Bench::new();
    let output = bench.kufe(&["press", "nowhere.toml", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        errors(&output).contains("nowhere.toml: cannot be read"),
        "{}",
        errors(&output)
    );
    assert!(bench.names().is_empty());
}

#[test]
fn values_out_of_range_are_named_with_file_line_and_range() {
    let bench = Bench::new();
    let rows: [(&str, &str, &[&str]); 9] = [
        (
            "fz_n = 1000.0",
            "fz = 1000.0",
            &["case.toml: line 10", "unknown field `fz`"],
        ),
        (
            "9.0e9",
            "nan",
            &[
                "case.toml: line 4: ice.youngs_modulus_pa = NaN",
                "a modulus in pascals from 1e6 to 1e13",
            ],
        ),
        (
            "9.0e9",
            "-1.0",
            &[
                "ice.youngs_modulus_pa = -1",
                "a modulus in pascals from 1e6 to 1e13",
            ],
        ),
        (
            "0.33",
            "0.5",
            &["line 5: ice.poissons_ratio = 0.5", "0 to 0.499"],
        ),
        ("0.33", "0.7", &["ice.poissons_ratio = 0.7", "0 to 0.499"]),
        (
            "fz_n = 1000.0",
            "fz_n = 0.0",
            &[
                "line 10: load.fz_n = 0",
                "a force in newtons from 0.001 to 1e7",
            ],
        ),
        (
            "fz_n = 1000.0",
            "fz_n = -3.0",
            &["load.fz_n = -3", "a force in newtons from 0.001 to 1e7"],
        ),
        ("fz_n = 1000.0", "", &["missing field `fz_n`"]),
        ("[track]", "[track", &["line 7"]),
    ];
    for (from, to, expected) in rows {
        refused(&bench, &changed(from, to), expected);
    }
}

#[test]
fn a_case_that_is_no_text_is_refused() {
    let bench = Bench::new();
    bench.write("case.toml", [0xff, 0xfe, 0x00, 0x80]);
    let output = bench.kufe(&["press", "case.toml", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        errors(&output).contains("case.toml: cannot be read"),
        "{}",
        errors(&output)
    );
}

#[test]
fn a_load_outside_the_hull_is_refused_with_both_places() {
    let bench = Bench::new();
    let text = changed("fz_n = 1000.0", "fz_n = 1000.0\noffset_x_m = 0.812345678");
    refused(
        &bench,
        &text,
        &["case.toml: ", "x = 0.8123 m, y = 0.0000 m misses the hull"],
    );
}

#[test]
fn a_load_beyond_what_the_hardness_bears_is_refused_with_the_capacity() {
    let bench = Bench::new();
    let text = changed(
        "thickness_m = 0.05",
        "thickness_m = 0.05\nhardness_pa = 1e5",
    );
    refused(&bench, &text, &["case.toml: ", "1000 N", "hardness"]);
}

#[test]
fn a_track_too_tight_for_the_hull_is_refused() {
    let bench = Bench::new();
    refused(
        &bench,
        &changed("inf", "1.0"),
        &["case.toml: ", "radius 1 m"],
    );
}

#[test]
fn an_output_in_a_file_is_refused_before_the_work() {
    let bench = Bench::new();
    bench.write("taken", "");
    let output = bench.kufe(&["press", "-o", "taken/out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        errors(&output).contains("cannot be written"),
        "{}",
        errors(&output)
    );
    assert_eq!(bench.names(), ["taken"]);
}

/// A limit on file sizes replaces a full disk; the shell ignores its signal, so writes fail.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_leaves_nothing_half_written() {
    let bench = Bench::new();
    let script = format!(
        "trap '' XFSZ; ulimit -f 8; exec '{}' press -o out",
        env!("CARGO_BIN_EXE_kufe")
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(bench.folder.path())
        .output()
        .expect("a shell");
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(
        errors(&output).contains("cannot be written"),
        "{}",
        errors(&output)
    );
    assert!(bench.names().is_empty(), "{:?}", bench.names());
}

/// A real disk of 64 KiB, where this process may mount one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_left_empty() {
    let bench = Bench::new();
    let disk = bench.path("disk");
    std::fs::create_dir(&disk).expect("a folder");
    let mount = |program: &str, words: &[&str]| {
        std::process::Command::new(program)
            .args(words)
            .arg(&disk)
            .output()
            .is_ok_and(|output| output.status.success())
    };
    if !mount("mount", &["-t", "tmpfs", "-o", "size=64k", "kufe-test"]) {
        not_here("no tmpfs can be mounted");
        return;
    }
    let output = bench.kufe(&["press", "-o", "disk/out"]);
    let remaining = names(&disk);
    assert!(mount("umount", &[]), "the disk stays mounted");
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    let printed = errors(&output);
    assert!(
        printed.contains("disk/out/") && printed.contains("cannot be written: No space left"),
        "{printed}"
    );
    assert!(remaining.is_empty(), "{remaining:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_no_one_may_write_is_refused_before_the_work() {
    let bench = Bench::new();
    for out in ["/proc/kufe", "/dev/full/out"] {
        let output = bench.kufe(&["press", "-o", out]);
        assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
        let printed = errors(&output);
        assert!(
            printed.contains(out) && printed.contains("cannot be written"),
            "{printed}"
        );
        assert_eq!(printed.lines().count(), 1, "{printed}");
    }
}

#[test]
fn earlier_results_survive_a_failure_whole() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "-o", "out"]);
    let before = std::fs::read(bench.path("out/result.json")).expect("a result");
    bench.write("case.toml", changed("0.33", "0.6"));
    assert_eq!(
        bench
            .kufe(&["press", "case.toml", "-o", "out"])
            .status
            .code(),
        Some(3)
    );
    assert_eq!(
        std::fs::read(bench.path("out/result.json")).expect("a result"),
        before
    );
    assert!(
        names(&bench.path("out"))
            .iter()
            .all(|name| !name.starts_with('.'))
    );
}

#[test]
fn an_accuracy_out_of_reach_leaves_with_code_4_or_is_met() {
    let bench = Bench::new();
    bench.write("case.toml", changed("p_max = 0.02", "p_max = 0.0001"));
    let output = bench.kufe(&["press", "case.toml", "-o", "out"]);
    match output.status.code() {
        Some(4) => {
            let text = std::fs::read_to_string(bench.path("out/result.json")).expect("a result");
            assert!(text.contains("\"accuracy_reached\": false"), "{text}");
        }
        Some(0) => {
            let text = std::fs::read_to_string(bench.path("out/result.json")).expect("a result");
            let result: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            let [p, error] =
                ["p_max_pa", "p_max_error_pa"].map(|key| result[key].as_f64().expect(key));
            assert!(error <= 1e-4 * p, "{error} of {p}");
        }
        other => panic!("{other:?}: {}", errors(&output)),
    }
}

#[test]
fn wrong_arguments_leave_with_code_2() {
    let bench = Bench::new();
    for words in [
        &["press", "--threads", "0"][..],
        &["press", "--no-such-option"],
        &["nonsense"],
        &[
            "evaluate",
            "runs.csv",
            "--model",
            "model.toml",
            "--cutoff-hz",
            "1e-9",
        ],
    ] {
        assert_eq!(bench.kufe(words).status.code(), Some(2), "{words:?}");
    }
    assert!(bench.names().is_empty());
}

#[test]
fn a_text_in_a_numbers_place_is_refused_in_the_words_of_its_range() {
    let bench = Bench::new();
    for (from, to, expected) in [
        (
            "fz_n = 1000.0",
            "fz_n = \"1 kN\"",
            "line 10: load.fz_n = \"1 kN\": expected a force in newtons from 0.001",
        ),
        (
            "length_m = 1.0",
            "length_m = \"1 m\"",
            "runner.shape.length_m = \"1 m\": expected a length in metres",
        ),
        (
            "youngs_modulus_pa = 9.0e9",
            "youngs_modulus_pa = \"9 GPa\"",
            "ice.youngs_modulus_pa = \"9 GPa\": expected a modulus",
        ),
        (
            "radius_m = inf",
            "radius_m = \"flat\"",
            "found \"flat\", expected a number",
        ),
        (
            "thickness_m = 0.05",
            "thickness_m = \"50 mm\"",
            "expected a thickness in metres or \"half-space\"",
        ),
    ] {
        refused(&bench, &changed(from, to), &[expected]);
    }
}
