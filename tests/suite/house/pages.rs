//! What the pages for people say of the code: files that are there, words that the glossary explains.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::files::{crates, root, rust_files};

/// Markdown files for people.
fn pages() -> Vec<PathBuf> {
    let mut pages = Vec::new();
    for folder in [root(), root().join("docs")] {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        pages.extend(
            entries
                .map(|e| e.path())
                .filter(|p| p.extension().is_some_and(|e| e == "md")),
        );
    }
    pages.sort();
    pages
}

/// What stands between backquotes in a text, fenced blocks apart.
fn quoted(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut fenced = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            found.extend(line.split('`').skip(1).step_by(2).map(str::to_owned));
        }
    }
    found
}

#[test]
fn every_source_file_that_a_page_names_is_there() {
    let names: BTreeSet<String> = rust_files(&root())
        .iter()
        .filter_map(|p| Some(p.file_name()?.to_string_lossy().to_string()))
        .collect();
    let mut faults = Vec::new();
    for page in pages() {
        if page.ends_with("CHANGELOG.md") {
            continue;
        }
        let text = std::fs::read_to_string(&page).unwrap_or_default();
        for word in quoted(&text) {
            let is_path = word.contains("/src/") || word.ends_with(".rs") && word.contains('/');
            // A word in capitals stands for a name of one's own.
            let plain = word
                .chars()
                .all(|c| c.is_alphanumeric() && !c.is_uppercase() || "/._-".contains(c));
            let known = if is_path {
                root().join(&word).exists()
            } else {
                !word.ends_with(".rs") || names.contains(&word)
            };
            if plain && !known {
                faults.push(format!("{}: {word}", page.display()));
            }
        }
    }
    super::told(faults);
}

#[test]
fn micrometres_are_written_with_their_sign() {
    let plain: String = ['u', 'm'].iter().collect();
    let mut faults = Vec::new();
    let mut files = rust_files(&root());
    files.extend(pages());
    for path in files.iter().filter(|path| !path.ends_with("CHANGELOG.md")) {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let word = |c: char| !c.is_alphanumeric() && !"_.-".contains(c);
        let lines = text.lines().enumerate();
        // A dot before it makes it part of an address, one behind it ends a sentence.
        let told = lines.filter(|(_, line)| {
            line.match_indices(&plain).any(|(at, _)| {
                line[..at].chars().next_back().is_none_or(word)
                    && !line[at + 2..].starts_with(|c: char| c.is_alphanumeric() || c == '_')
            })
        });
        faults.extend(told.map(|(n, line)| format!("{}:{}: {line}", path.display(), n + 1)));
    }
    super::told(faults);
}

/// The words of a type's or folder's name, in lower case: `MuTableFit`, `mu_table_fit` -> mu, table, fit.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last_is_lower = false;
    for c in name.chars() {
        if c == '_' || c.is_uppercase() && last_is_lower || words.is_empty() {
            words.push(String::new());
        }
        last_is_lower = c.is_lowercase() || c.is_ascii_digit();
        if let (Some(word), true) = (words.last_mut(), c != '_') {
            word.extend(c.to_lowercase());
        }
    }
    words.retain(|w| !w.is_empty());
    words
}

/// Names of the types that leave their file, and of folders, each with a place where it stands.
fn names() -> BTreeMap<String, PathBuf> {
    let mut found = BTreeMap::new();
    for folder in crates() {
        let source = folder.join("src");
        for path in rust_files(&source) {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            for line in text.lines() {
                let Some(rest) = line.trim_start().strip_prefix("pub") else {
                    continue;
                };
                let rest = rest.strip_prefix("(crate)").unwrap_or(rest).trim_start();
                let kinds = ["struct ", "enum ", "trait ", "type "];
                let Some(rest) = kinds.iter().find_map(|k| rest.strip_prefix(k)) else {
                    continue;
                };
                let name: String = rest.chars().take_while(|c| c.is_alphanumeric()).collect();
                found.entry(name).or_insert_with(|| path.clone());
            }
            let rooms = path.strip_prefix(&source).unwrap_or(Path::new("")).parent();
            for room in rooms.into_iter().flat_map(Path::iter) {
                let room = room.to_string_lossy().to_string();
                found.entry(room).or_insert_with(|| path.clone());
            }
        }
    }
    found
}

#[test]
fn the_glossary_holds_every_word_of_a_type_or_folder() {
    let pages = ["docs/glossary.md", "tests/suite/house/words.md"];
    let text = pages
        .map(|page| std::fs::read_to_string(root().join(page)).unwrap())
        .concat()
        .to_lowercase();
    let held: BTreeSet<&str> = text.split(|c: char| !c.is_alphanumeric()).collect();
    let mut faults = Vec::new();
    for (name, path) in names() {
        for word in words(&name) {
            let singular = word.strip_suffix('s').unwrap_or(&word);
            if word.len() > 1 && !held.contains(word.as_str()) && !held.contains(singular) {
                faults.push(format!("{word} (of {name}, {})", path.display()));
            }
        }
    }
    super::told(faults);
}

#[test]
fn names_are_split_into_their_words() {
    assert_eq!(words("MuTableFit"), ["mu", "table", "fit"]);
    assert_eq!(words("active_set"), ["active", "set"]);
    assert_eq!(words("Hex8Axial"), ["hex8", "axial"]);
    assert_eq!(quoted("a `b` c\n```\n`d`\n```\n`e`"), ["b", "e"]);
}
