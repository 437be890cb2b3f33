//! Layout of the code: the folders of a crate import one another in one direction.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Graph = BTreeMap<String, BTreeSet<String>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.path()) {
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// A source without comments and without the tests at its end.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    let lines = text[..end].lines();
    let code = lines.map(|line| line.split("//").next().unwrap_or_default());
    code.collect::<Vec<_>>().join("\n")
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word_at(text: &str) -> &str {
    &text[..text.find(|c| !is_word(c)).unwrap_or(text.len())]
}

/// First path segments after `crate::`, including those within braces.
fn first_names(code: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for part in code.split("crate::").skip(1) {
        let Some(inside) = part.strip_prefix('{') else {
            names.insert(word_at(part).to_string());
            continue;
        };
        let (mut depth, mut item) = (0, String::new());
        for c in inside.chars() {
            match c {
                '}' if depth == 0 => break,
                ',' if depth == 0 => {
                    names.insert(word_at(item.trim_start()).to_string());
                    item.clear();
                    continue;
                }
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            item.push(c);
        }
        names.insert(word_at(item.trim_start()).to_string());
    }
    names
}

/// Imports between the folders of a crate's `src`. Items that `lib.rs` re-exports count for the
/// folder that defines them.
fn imports(source: &Path) -> Graph {
    let entries = std::fs::read_dir(source).into_iter().flatten().flatten();
    let folders = entries.map(|e| e.path()).filter(|path| path.is_dir());
    let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().to_string());
    let folders: BTreeSet<String> = folders.filter_map(|path| name(&path)).collect();
    let mut home: BTreeMap<String, String> = BTreeMap::new();
    for statement in code(&source.join("lib.rs")).split("pub use ").skip(1) {
        let statement = statement.split(';').next().unwrap_or_default();
        let mut words = statement.split(|c| !is_word(c)).filter(|w| !w.is_empty());
        if let Some(folder) = words.next().filter(|first| folders.contains(*first)) {
            home.extend(words.map(|word| (word.to_string(), folder.to_string())));
        }
    }
    let mut graph = Graph::new();
    for folder in &folders {
        let edges = graph.entry(folder.clone()).or_default();
        let files = rust_files(&source.join(folder)).into_iter();
        // Tests may import from any folder.
        for path in files.filter(|p| !p.to_string_lossy().ends_with("tests.rs")) {
            for first in first_names(&code(&path)) {
                let to = folders.get(&first).or_else(|| home.get(&first));
                edges.extend(to.filter(|to| *to != folder).cloned());
            }
        }
    }
    graph
}

/// Nodes reachable from `from` in one step or more.
fn reached(graph: &Graph, from: &str) -> BTreeSet<String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_string()]);
    while let Some(at) = open.pop() {
        for next in graph.get(&at).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    seen
}

fn in_cycles(graph: &Graph) -> Vec<&String> {
    graph
        .keys()
        .filter(|n| reached(graph, n).contains(*n))
        .collect()
}

#[test]
fn folders_of_a_crate_import_one_another_in_one_direction() {
    let entries = std::fs::read_dir(root()).expect("the workspace").flatten();
    let crates = entries.map(|entry| entry.path());
    let mut checked = 0;
    for folder in crates.filter(|path| path.join("Cargo.toml").exists()) {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let graph = imports(&folder.join("src"));
        let cycle = in_cycles(&graph);
        assert!(cycle.is_empty(), "{name}: {cycle:?} in {graph:#?}");
        checked += usize::from(graph.len() > 1);
    }
    assert!(checked >= 3, "{checked} crates with folders");
}

#[test]
fn a_cycle_of_folders_is_detected() {
    let graph = |edges: &[(&str, &[&str])]| -> Graph {
        let of = |(from, to): &(&str, &[&str])| {
            (
                from.to_string(),
                to.iter().map(ToString::to_string).collect(),
            )
        };
        edges.iter().map(of).collect()
    };
    assert!(in_cycles(&graph(&[("a", &["b"]), ("b", &["c"]), ("c", &[])])).is_empty());
    let ring = graph(&[("a", &["b"]), ("b", &["a"]), ("c", &["a"])]);
    assert_eq!(in_cycles(&ring), ["a", "b"]);
    let names = first_names("use crate::a::X;\nuse crate::{b::{C, D}, Error, d};");
    assert_eq!(
        names,
        ["Error", "a", "b", "d"]
            .map(String::from)
            .into_iter()
            .collect()
    );
}
