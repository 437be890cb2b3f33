//! Which file of a crate imports from which.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::files::rust_files;
use super::text::{absolute, code_of, paths_in, uses};

/// One crate's files by their module path, `crate::room::file`.
pub struct Crate {
    pub name: String,
    files: BTreeMap<String, Source>,
}

struct Source {
    path: PathBuf,
    /// The text without comments, strings and its own tests.
    code: String,
    /// What a file passes on by `pub use`: name to full path; globs apart.
    passes_on: BTreeMap<String, String>,
    globs: Vec<String>,
}

pub fn is_first_page(path: &Path) -> bool {
    ["lib.rs", "main.rs", "mod.rs"]
        .iter()
        .any(|name| path.ends_with(name))
}

impl Crate {
    pub fn read(folder: &Path) -> Crate {
        let source = folder.join("src");
        let mut files = BTreeMap::new();
        for path in rust_files(&source) {
            let Ok(text) = std::fs::read_to_string(&path) else {
                continue;
            };
            let inside = path
                .strip_prefix(&source)
                .unwrap_or(&path)
                .with_extension("");
            let mut module = vec!["crate".to_string()];
            module.extend(inside.iter().map(|p| p.to_string_lossy().to_string()));
            if ["lib", "main", "mod"].contains(&module.last().map_or("", String::as_str)) {
                module.pop();
            }
            let code = code_of(&text);
            let key = match inside.to_str() {
                Some("main") if source.join("lib.rs").exists() => continue,
                _ => module.join("::"),
            };
            files.insert(
                key,
                Source {
                    path,
                    code,
                    passes_on: BTreeMap::new(),
                    globs: Vec::new(),
                },
            );
        }
        let modules: BTreeSet<String> = files.keys().cloned().collect();
        for (module, file) in &mut files {
            let first = is_first_page(&file.path);
            for (passes, path, name) in uses(&file.code) {
                let Some(whole) = absolute(&path, module, first, &modules).filter(|_| passes)
                else {
                    continue;
                };
                if name == "*" {
                    file.globs.push(whole.trim_end_matches("::*").to_string());
                } else {
                    file.passes_on.insert(name, whole);
                }
            }
        }
        let name = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .to_string();
        Crate { name, files }
    }

    /// The file that defines what a path names.
    fn home(&self, path: &str, depth: usize) -> Option<String> {
        let parts: Vec<&str> = path.split("::").collect();
        let known = (1..=parts.len())
            .rev()
            .find(|&n| self.files.contains_key(&parts[..n].join("::")))?;
        let module = parts[..known].join("::");
        let file = &self.files[&module];
        let Some(item) = parts.get(known) else {
            return Some(module);
        };
        if depth > 8 {
            return Some(module);
        }
        if let Some(further) = file.passes_on.get(*item) {
            return self.home(further, depth + 1);
        }
        for glob in &file.globs {
            let home = self.home(&format!("{glob}::{item}"), depth + 1);
            if let Some(home) = home.filter(|h| self.defines(h, item)) {
                return Some(home);
            }
        }
        Some(module)
    }

    fn defines(&self, module: &str, item: &str) -> bool {
        let code = &self.files[module].code;
        ["fn", "struct", "enum", "trait", "const", "static", "type"]
            .iter()
            .any(|word| code.contains(&format!("{word} {item}")))
    }

    /// Which files a file imports from.
    pub fn imports(&self) -> BTreeMap<&str, BTreeSet<String>> {
        let modules: BTreeSet<String> = self.files.keys().cloned().collect();
        let mut graph = BTreeMap::new();
        for (module, file) in &self.files {
            let first = is_first_page(&file.path);
            let mut homes = BTreeSet::new();
            let mut paths: Vec<String> = uses(&file.code)
                .into_iter()
                .filter(|(passes, ..)| !passes)
                .map(|(_, path, _)| path)
                .collect();
            paths.extend(paths_in(&file.code));
            for path in paths {
                let whole = absolute(path.trim_end_matches("::*"), module, first, &modules);
                // What a glob of an own parent brings is not followed: such a file names its parent.
                if let Some(home) = whole.and_then(|w| self.home(&w, 0)) {
                    homes.insert(home);
                }
            }
            homes.remove(module);
            graph.insert(module.as_str(), homes);
        }
        graph
    }
}

/// A circle of imports, if there is one: the files in their order.
pub fn circles(graph: &BTreeMap<&str, BTreeSet<String>>) -> Vec<Vec<String>> {
    // Tarjan would do; files are few, so reachability is enough and simpler to read.
    let reach = |from: &str| {
        let mut seen = BTreeSet::new();
        let mut open = vec![from.to_string()];
        while let Some(at) = open.pop() {
            for next in graph.get(at.as_str()).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&str, BTreeSet<String>> = graph.keys().map(|m| (*m, reach(m))).collect();
    let mut told = BTreeSet::new();
    let mut found = Vec::new();
    for (module, seen) in &reached {
        if !seen.contains(*module) || told.contains(*module) {
            continue;
        }
        let circle: Vec<String> = seen
            .iter()
            .filter(|other| {
                reached
                    .get(other.as_str())
                    .is_some_and(|r| r.contains(*module))
            })
            .cloned()
            .collect();
        told.extend(circle.iter().cloned());
        found.push(circle);
    }
    found
}
