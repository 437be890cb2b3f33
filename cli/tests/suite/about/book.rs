//! The book: every page is in its table of contents, every link leads somewhere, the reference has every command.

use std::path::{Path, PathBuf};

use crate::kufe::Bench;

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

/// Written by `kufe man --markdown` when the book is made.
const GENERATED: &str = "command.md";

fn pages() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(docs()).expect("docs/");
    let mut pages: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect();
    pages.sort();
    pages
}

/// Targets of the links in a page, without code blocks: `](TARGET)`.
fn links(text: &str) -> Vec<String> {
    let prose: Vec<&str> = text.split("```").step_by(2).collect();
    prose
        .iter()
        .flat_map(|part| part.split("](").skip(1))
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.to_owned())
        .collect()
}

#[test]
fn the_table_of_contents_has_every_page_once_and_no_other() {
    let summary = std::fs::read_to_string(docs().join("SUMMARY.md")).expect("SUMMARY.md");
    let mut listed = links(&summary);
    listed.sort();
    let mut there: Vec<String> = pages()
        .iter()
        .map(|page| {
            page.file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned()
        })
        .filter(|name| name != "SUMMARY.md" && name != GENERATED)
        .chain([GENERATED.to_owned()])
        .collect();
    there.sort();
    assert_eq!(
        listed, there,
        "docs/SUMMARY.md lists the left, docs/ has the right"
    );
}

#[test]
fn every_link_between_pages_leads_somewhere() {
    let mut looked_at = 0;
    let readme = docs().join("../README.md");
    for page in pages().into_iter().chain([readme]) {
        let text = std::fs::read_to_string(&page).expect("text");
        let folder = page.parent().expect("a folder");
        for link in links(&text) {
            let target = link.split('#').next().unwrap_or_default();
            let elsewhere = link.contains("://") || target.is_empty();
            if !elsewhere && !target.ends_with(GENERATED) {
                let there = folder.join(target);
                assert!(there.exists(), "{}: {link}: no such file", page.display());
                looked_at += 1;
            }
        }
    }
    assert!(looked_at > 20, "{looked_at} links");
}

#[test]
fn the_reference_has_the_help_of_every_command() {
    let bench = Bench::new();
    bench.succeeds(&["man", "--markdown", "command.md"]);
    let page = std::fs::read_to_string(bench.path("command.md")).expect("the page");
    let spaced = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let flat = spaced(&page);
    for words in [
        &["press"][..],
        &["lut"],
        &["lut", "query"],
        &["fit", "lateral"],
        &["discover"],
    ] {
        let title = format!("\n## kufe {}\n", words.join(" "));
        assert!(page.contains(&title), "{title}");
        let help = bench.succeeds(&[words, &["--help"]].concat());
        // Every command's own options appear once, in another style where a command explains them further.
        for line in help.lines().filter(|line| !line.contains("Print help")) {
            assert!(flat.contains(&spaced(line)), "{words:?}: {line:?}");
        }
    }
}

/// What pages write as a command: `kufe ...` between backticks, and lines of blocks that nothing runs.
fn commands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (k, part) in text.split("```").enumerate() {
        if k % 2 == 0 {
            found.extend(part.split('`').skip(1).step_by(2));
        } else if let Some(block) = part.strip_prefix("console") {
            found.extend(block.lines());
        }
    }
    found
        .into_iter()
        .filter_map(|line| line.split(" #").next())
        .filter_map(|line| line.trim().strip_prefix("kufe "))
        .filter(|line| !line.contains(['[', '|', '$', '>']))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_command_that_a_page_names_is_one() {
    let bench = Bench::new();
    let others = ["../README.md", "../ARCHITECTURE.md"].map(|name| docs().join(name));
    let mut seen = Vec::new();
    let written = pages()
        .into_iter()
        .filter(|page| !page.ends_with(GENERATED));
    for page in written.chain(others) {
        let text = std::fs::read_to_string(&page).expect("text");
        for line in commands(&text) {
            // Words are read from left to right: a wrong one is reported before the help is printed.
            let words: Vec<&str> = line.split_whitespace().chain(["--help"]).collect();
            let output = bench.kufe(&words);
            let reported = String::from_utf8_lossy(&output.stderr);
            assert!(
                output.status.success(),
                "{}: kufe {line}: {reported}",
                page.display()
            );
            seen.push(line);
        }
    }
    assert!(seen.len() > 30, "{seen:?}");
}
