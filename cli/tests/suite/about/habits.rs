//! What every command does alike on a terminal and without one.

use std::collections::BTreeSet;
use std::process::{Command, Output};

use crate::kufe::{Bench, CASE, errors};

fn plain(output: &Output) -> bool {
    !output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b)
}

#[test]
fn without_a_terminal_there_is_no_progress_and_verbose_prints_each_step() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let silent = bench.kufe(&["press", "case.toml"]);
    assert!(plain(&silent));
    let reported: Vec<String> = errors(&silent).lines().map(str::to_string).collect();
    assert!(
        reported
            .iter()
            .all(|line| line.starts_with("kufe: warning: ")),
        "{reported:?}"
    );
    let printed = errors(&bench.kufe(&["press", "case.toml", "-v"]));
    for part in ["threads", "mesh 1: ", "mesh 2: ", "unknowns", "residual"] {
        assert!(printed.contains(part), "{part:?} is missing: {printed}");
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

/// The commands within a command, as its help lists them.
fn commands(bench: &Bench, words: &[&str]) -> Vec<String> {
    let help = bench.succeeds(&[words, &["--help"]].concat());
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    listed
        .take_while(|line| line.starts_with("  "))
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_command_within_commands_has_a_manual_page_of_its_own() {
    let bench = Bench::new();
    let printed = bench.succeeds(&["man", "-o", "man"]);
    let (mut open, mut pages) = (vec![Vec::new()], BTreeSet::new());
    while let Some(path) = open.pop() {
        let words: Vec<&str> = path.iter().map(String::as_str).collect();
        let name = [&["kufe"], &words[..]].concat().join("-");
        let page = std::fs::read_to_string(bench.path(&format!("man/{name}.1")))
            .unwrap_or_else(|error| panic!("{name}.1: {error}"));
        // Roff writes a hyphen with a backslash before it.
        let page = page.replace("\\-", "-");
        let title = format!(".TH {name} 1");
        assert!(page.contains(&title), "{name}: {page}");
        assert!(!page.contains("help(1)"), "{name}: {page}");
        for inner in commands(&bench, &words) {
            assert!(
                page.contains(&format!("{name}-{inner}(1)")),
                "{inner}: {page}"
            );
            open.push([path.clone(), vec![inner]].concat());
        }
        pages.insert(format!("{name}.1"));
    }
    for name in [
        "kufe-lut-query.1",
        "kufe-hull-check.1",
        "kufe-runs-import.1",
    ] {
        assert!(pages.contains(name), "{pages:?}");
    }
    let written: BTreeSet<String> = std::fs::read_dir(bench.path("man"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .filter(|name| name != ".kufe.json")
        .collect();
    assert_eq!(written, pages);
    assert!(
        printed.starts_with(&format!("{} pages ", pages.len())),
        "{printed}"
    );
}

#[test]
fn a_misspelt_subcommand_is_answered_with_its_like() {
    let bench = Bench::new();
    for (words, name) in [
        (&["pres"][..], "press"),
        (&["lut", "qeury", "t.lut"], "query"),
        (&["lut", "shwo", "t.lut"], "show"),
        (&["runs", "chekc", "runs.csv"], "check"),
        (&["friction", "fitt", "experiments.csv"], "fit"),
    ] {
        let output = bench.kufe(words);
        let reported = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {reported}");
        let tip = format!("a similar subcommand exists: '{name}'");
        assert!(reported.contains(&tip), "{words:?}: {reported}");
    }
    let output = bench.kufe(&["lut", "query", "t.lut", "--quiet", "--verbose"]);
    assert!(
        errors(&output).contains("cannot be used with"),
        "{}",
        errors(&output)
    );
}
