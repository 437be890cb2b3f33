//! The rules by which the code is laid out: short files, rooms of few files, no circle of imports, pages that name what
//! is there.

mod files;
mod imports;
mod pages;
mod parallel;
mod text;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use files::{crates, root, rust_files};
use imports::{Crate, circles};
use text::leaves;

/// Longest file [lines].
const LINES: usize = 400;

/// Most files of a crate's `src` beside its rooms, of a folder of tests or examples, and of a room.
const FLAT: usize = 15;
const ROOM: std::ops::RangeInclusive<usize> = 2..=12;

fn told(mut faults: Vec<String>) {
    faults.sort();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn no_file_is_longer_than_four_hundred_lines() {
    let mut faults = Vec::new();
    for path in rust_files(&root()) {
        let lines = std::fs::read_to_string(&path).map_or(0, |t| t.lines().count());
        if lines > LINES {
            faults.push(format!("{}: {lines} lines", path.display()));
        }
    }
    told(faults);
}

#[test]
fn rooms_hold_two_to_twelve_files_and_say_what_happens_there() {
    let mut faults = Vec::new();
    for folder in crates() {
        let source = folder.join("src");
        for (room, entries) in rooms(&source) {
            if room == source {
                if entries > FLAT {
                    faults.push(format!(
                        "{}: {entries} files, expected at most {FLAT}",
                        room.display()
                    ));
                }
                continue;
            }
            let page = room.join("mod.rs");
            let text = std::fs::read_to_string(&page).unwrap_or_default();
            if !text.starts_with("//!") {
                faults.push(format!(
                    "{}: no first page that says what happens there",
                    page.display()
                ));
            }
            if room.with_extension("rs").exists() {
                faults.push(format!("{}.rs beside its folder", room.display()));
            }
            if !ROOM.contains(&entries) {
                faults.push(format!(
                    "{}: {entries} files beside its first page, expected 2 to 12",
                    room.display()
                ));
            }
        }
    }
    told(faults);
}

#[test]
fn nothing_is_flat_with_over_fifteen_files() {
    let mut folders: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for path in rust_files(&root()) {
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        *folders.entry(folder).or_default() += 1;
    }
    let many = folders.into_iter().filter(|(_, files)| *files > FLAT);
    told(
        many.map(|(folder, files)| format!("{}: {files} files", folder.display()))
            .collect(),
    );
}

/// Rooms below `source` with what each holds beside its first page: files, and rooms of its own; programs in `bin` are none.
fn rooms(source: &PathBuf) -> BTreeMap<PathBuf, usize> {
    let mut rooms: BTreeMap<PathBuf, BTreeSet<PathBuf>> = BTreeMap::new();
    for path in rust_files(source) {
        if path.components().any(|c| c.as_os_str() == "bin") {
            continue;
        }
        let mut entry = path;
        while entry != *source {
            let Some(folder) = entry.parent().map(PathBuf::from) else {
                break;
            };
            if !entry.ends_with("mod.rs") && (folder != *source || entry.is_file()) {
                rooms.entry(folder.clone()).or_default().insert(entry);
            }
            entry = folder;
        }
    }
    rooms
        .into_iter()
        .map(|(room, entries)| (room, entries.len()))
        .collect()
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut faults = Vec::new();
    for folder in crates() {
        let krate = Crate::read(&folder);
        for circle in circles(&krate.imports()) {
            faults.push(format!("{}: {}", krate.name, circle.join(" <-> ")));
        }
    }
    told(faults);
}

#[test]
fn no_function_takes_more_arguments_than_clippy_allows() {
    let mut faults = Vec::new();
    for path in rust_files(&root()) {
        // The keywords of a Python function are its struct.
        if path.starts_with(root().join("python")) {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let word = concat!("too_many", "_arguments");
        if text.contains(word) {
            faults.push(format!("{} allows {word}", path.display()));
        }
    }
    told(faults);
}

#[test]
fn a_circle_is_found_where_there_is_one() {
    let graph = |edges: &[(&'static str, &[&str])]| -> BTreeMap<&str, BTreeSet<String>> {
        let of = |(from, to): &(&'static str, &[&str])| {
            (*from, to.iter().map(|t| t.to_string()).collect())
        };
        edges.iter().map(of).collect()
    };
    let line = graph(&[("a", &["b"]), ("b", &["c"]), ("c", &[])]);
    assert!(circles(&line).is_empty());
    let ring = graph(&[("a", &["b"]), ("b", &["c"]), ("c", &["a"]), ("d", &["a"])]);
    assert_eq!(circles(&ring), [["a", "b", "c"].map(String::from).to_vec()]);
    let mut paths = Vec::new();
    leaves("", "crate::a::{b::C, d::{E as F, self}, g::*}", &mut paths);
    let names: Vec<&str> = paths.iter().map(|(_, n)| n.as_str()).collect();
    assert_eq!(names, ["C", "F", "d", "*"]);
    assert_eq!(paths[2].0, "crate::a::d");
}
