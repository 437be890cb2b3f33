//! What every command does alike on a terminal and without one.

use std::process::{Command, Output};

use crate::kufe::{Bench, CASE, errors};

fn plain(output: &Output) -> bool {
    !output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b)
}

#[test]
fn without_a_terminal_there_is_no_progress_and_verbose_says_each_step() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let silent = bench.kufe(&["press", "case.toml"]);
    assert!(plain(&silent));
    let told: Vec<String> = errors(&silent).lines().map(str::to_string).collect();
    assert!(
        told.iter().all(|line| line.starts_with("kufe: warning: ")),
        "{told:?}"
    );
    let said = errors(&bench.kufe(&["press", "case.toml", "-v"]));
    for part in ["threads", "mesh 1: ", "mesh 2: ", "unknowns", "residual"] {
        assert!(said.contains(part), "{part:?} is missing: {said}");
    }
    let both = bench.kufe(&["press", "case.toml", "-v", "-q"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn no_color_keeps_help_and_errors_plain() {
    let bench = Bench::new();
    for words in [
        &["--help"][..],
        &["press", "--nonsense"],
        &["lut", "--help"],
    ] {
        for (name, value) in [("NO_COLOR", "1"), ("TERM", "dumb")] {
            let output = Command::new(env!("CARGO_BIN_EXE_kufe"))
                .args(words)
                .env(name, value)
                .current_dir(bench.folder.path())
                .output()
                .expect("the command runs");
            assert!(plain(&output), "{words:?} with {name}");
        }
    }
}
