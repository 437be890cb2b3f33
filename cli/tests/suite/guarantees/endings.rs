//! How commands end: standard output that is closed, signals, accuracy out of reach, lists without end.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::kufe::{Bench, CASE, errors, json, names};
use crate::search::friction_table::MODEL;

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_cannot_be_written_ends_with_code_3() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write(
        "t.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\ncurvature_1pm = { values = [0.0] }\n",
    );
    bench.succeeds(&["lut", "t.toml", "-q"]);
    let rows: [&[&str]; 3] = [
        &[
            "lut",
            "query",
            "t.lut",
            "--fz-n",
            "700",
            "--radius-m",
            "inf",
        ],
        &["schema", "case"],
        &["press", "case.toml", "-o", "out"],
    ];
    for words in rows {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let output = Command::new(env!("CARGO_BIN_EXE_kufe"))
            .current_dir(bench.folder.path())
            .args(words)
            .stdout(full.expect("the full device"))
            .output()
            .expect("the command runs");
        let reported = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{words:?}: {reported}");
        assert!(
            reported.contains("standard output: cannot be written"),
            "{reported}"
        );
    }
    // The files were written all the same.
    assert!(bench.path("out/result.json").exists());
}

/// Runs `kufe` with outputs that nobody reads, or a full device.
#[cfg(target_os = "linux")]
#[test]
fn a_lost_reader_and_lost_messages_lose_no_result() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let run = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kufe"));
        command.current_dir(bench.folder.path()).args(words);
        command
    };
    for words in [
        &["schema", "model"][..],
        &["completions", "bash"],
        &["--help"],
    ] {
        let mut child = run(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the command runs");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
        assert_eq!(errors(&output), "");
    }
    let press = ["press", "case.toml", "-o", "out", "-v"];
    let full = std::fs::File::options().write(true).open("/dev/full");
    let full = run(&press).stderr(full.expect("the full device")).output();
    assert_eq!(full.expect("it runs").status.code(), Some(0));
    assert!(bench.path("out/result.json").exists());
    let mut child = run(&press)
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .expect("the command runs");
    drop(child.stderr.take());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

#[test]
fn threads_are_bounded() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let output = bench.kufe(&["press", "case.toml", "--threads", "100000"]);
    assert_eq!(output.status.code(), Some(2));
    let output = Command::new(env!("CARGO_BIN_EXE_kufe"))
        .env("RAYON_NUM_THREADS", "1000000")
        .current_dir(bench.folder.path())
        .args(["schema", "case"])
        .output()
        .expect("the command runs");
    assert!(output.status.success(), "{}", errors(&output));
}

#[cfg(unix)]
#[test]
fn a_series_that_is_terminated_keeps_its_steps_leaves_5_and_resumes() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let forces: Vec<String> = (1..=400).map(|k| format!("{}", 500 + k)).collect();
    let list = forces.join(",");
    let words = ["press", "case.toml", "-o", "out", "--fz-n", list.as_str()];
    let child = Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(bench.folder.path())
        .args(words)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    let begun = Instant::now();
    while !bench.path("out/step-001/result.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120), "no first step");
        std::thread::sleep(Duration::from_millis(20));
    }
    let reported = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(reported.success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(5), "{}", errors(&output));
    let remaining = names(&bench.path("out"));
    assert!(
        remaining.iter().all(|name| !name.starts_with(".kufe")),
        "{remaining:?}"
    );
    let rows = json(&bench.path("out/table.json"));
    let done = rows.as_array().expect("rows").len();
    assert!((1..400).contains(&done), "{done}");
}

/// Whether a process has a handler of SIGTERM; if the system does not state that, true after a moment.
#[cfg(unix)]
fn handles_termination(process: u32) -> bool {
    const SIGTERM: u32 = 15;
    let Ok(status) = std::fs::read_to_string(format!("/proc/{process}/status")) else {
        std::thread::sleep(Duration::from_millis(200));
        return true;
    };
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    caught.is_some_and(|mask| mask >> (SIGTERM - 1) & 1 == 1)
}

#[cfg(target_os = "linux")]
#[test]
fn the_next_command_removes_what_a_killed_one_left() {
    let bench = Bench::new();
    bench.write("case.toml", CASE.replace("p_max = 0.02", "p_max = 0.0001"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(bench.folder.path())
        .args(["press", "case.toml", "-o", "out", "-q"])
        .spawn()
        .expect("the command runs");
    let hidden = || {
        let there = std::fs::read_dir(bench.path("out")).into_iter().flatten();
        let names = there.map(|entry| entry.expect("an entry").file_name());
        names
            .filter(|name| name.to_string_lossy().starts_with(".kufe-"))
            .count()
    };
    let begun = Instant::now();
    while hidden() == 0 {
        assert!(begun.elapsed() < Duration::from_secs(60), "no folder");
        std::thread::sleep(Duration::from_millis(5));
    }
    // The folder of a process that lives stays.
    bench.write("other.toml", CASE);
    bench.succeeds(&["press", "other.toml", "-o", "out", "-q"]);
    assert_eq!(hidden(), 1);
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    assert_eq!(hidden(), 1);
    bench.succeeds(&["press", "other.toml", "-o", "out", "-q"]);
    assert_eq!(hidden(), 0);
}

#[cfg(unix)]
#[test]
fn a_command_that_is_terminated_leaves_nothing() {
    let bench = Bench::new();
    bench.write("case.toml", CASE.replace("p_max = 0.02", "p_max = 0.0001"));
    bench.write("model.toml", MODEL);
    // So many points take seconds.
    let points = (0..400).map(|k| {
        let mu = 0.0035 + 1e-5 * f64::from(37 * k % 61);
        format!("S{k},{}e4,5e5,{mu:.6},0.0003\n", 700 + 2 * k)
    });
    let head = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n";
    bench.write(
        "experiments.csv",
        head.to_owned() + &points.collect::<String>(),
    );
    let inputs = bench.names();
    let press = "press case.toml -o out";
    let discover = "discover experiments.csv --model model.toml --twins 1000 -o out";
    let export = "export case.toml --stiffness out/k.mtx";
    for words in [press, discover, export] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_kufe"))
            .current_dir(bench.folder.path())
            .args(words.split(' '))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the command runs");
        let begun = Instant::now();
        while !bench.path("out").exists() || !handles_termination(child.id()) {
            assert!(begun.elapsed() < Duration::from_secs(60), "no folder");
            std::thread::sleep(Duration::from_millis(2));
        }
        Command::new("kill")
            .args(["-TERM", &child.id().to_string()])
            .status()
            .expect("kill");
        let status = child.wait().expect("it ends");
        assert_eq!(status.code(), Some(130), "{words}");
        assert_eq!(bench.names(), inputs, "{words}");
    }
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn an_accuracy_out_of_reach_gives_the_best_answer_marked_and_4() {
    // On sharp edges the pressure has no limit.
    let bench = Bench::new();
    let worn = "section = { worn_m = 2e-5, worn_edge = 0.0 }\n[ice]";
    bench.write("case.toml", CASE.replacen("[ice]", worn, 1));
    let output = bench.kufe(&["press", "case.toml", "-o", "out"]);
    let reported = errors(&output);
    assert_eq!(output.status.code(), Some(4), "{reported}");
    assert!(reported.contains("requested 2.00 %"), "{reported}");
    let result = json(&bench.path("out/result.json"));
    assert_eq!(result["accuracy_reached"], false);
    assert_eq!(result["accuracy_asked"], 0.02);
    for printed in [
        String::from_utf8_lossy(&output.stdout).into_owned(),
        result["warnings"].to_string(),
    ] {
        assert!(
            printed.contains("the requested accuracy was not reached"),
            "{printed}"
        );
    }
    let figure = |key: &str| result[key].as_f64().expect("a number");
    assert!(figure("p_max_error_pa") > 0.02 * figure("p_max_pa"));
    assert!((figure("fz_n") / 1000.0 - 1.0).abs() < 1e-6);
    assert!(bench.path("out/pressure.exr").exists());
}

#[test]
fn where_hardness_fixes_the_peak_the_accuracy_applies_to_the_patch() {
    let bench = Bench::new();
    let lengths: Vec<[f64; 2]> = ["0.05", "0.02"]
        .iter()
        .map(|accuracy| {
            let case = CASE.replace("[track]", "hardness_pa = 30e6\n[track]");
            bench.write(
                "case.toml",
                case.replace("p_max = 0.02", &format!("p_max = {accuracy}")),
            );
            bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
            let result = json(&bench.path("out/result.json"));
            let figure = |key: &str| result[key].as_f64().expect("a number");
            assert!(figure("p_max_pa") <= 30e6 && figure("p_max_error_pa") == 0.0);
            assert!(figure("p_max_mesh_pa") <= 30e6);
            let accuracy: f64 = accuracy.parse().expect("a number");
            assert!(figure("area_error_m2") <= 4.0 * accuracy * figure("area_m2"));
            [figure("length_m"), figure("length_error_m")]
        })
        .collect();
    // Each answer is within the other's bounds.
    let [coarse, fine] = [lengths[0], lengths[1]];
    assert!(
        (coarse[0] - fine[0]).abs() <= coarse[1] + fine[1],
        "{lengths:?}"
    );
}

#[test]
fn endless_lists_are_refused_and_every_step_is_checked_before_the_first() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let list: String = (0..300).map(|k| format!("{},", 500 + k)).collect();
    let list = list.trim_end_matches(',');
    let words = [
        "press",
        "case.toml",
        "--fz-n",
        list,
        "--radius-m",
        list,
        "--rocker-radius-m",
        list,
    ];
    let started = Instant::now();
    let output = bench.kufe(&words);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("27000000 combinations"),
        "{}",
        errors(&output)
    );
    assert!(started.elapsed() < Duration::from_secs(10));
    // The last radius is too tight for the hull: nothing is solved.
    let output = bench.kufe(&["press", "case.toml", "-o", "out", "--radius-m", "50,25,1"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(errors(&output).contains("step-003"), "{}", errors(&output));
    assert_eq!(bench.names(), ["case.toml"]);
}
