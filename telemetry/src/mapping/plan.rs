//! Which runs there are, and the files of each.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::mapping::check::plain_name;
use crate::mapping::file::{IndexValues, Mapping};
use crate::mapping::index::read_table;
use crate::source::bytes_of;

/// One run to import.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRun {
    /// Its name, that of its files too.
    pub name: String,
    /// Its recording by logger.
    pub files: BTreeMap<String, PathBuf>,
    /// Delays stated for this run [s].
    pub delay_s: BTreeMap<String, f64>,
    /// What `runs.csv` says of it.
    pub index: IndexValues,
}

/// The runs of a mapping that stands in `folder`, by name, and every file that they are made of besides recordings.
///
/// A run is what the `*` of a logger's pattern stands for, or a table `[[run]]`; every logger must have a file of every run.
///
/// # Errors
/// [`Error::Key`] for a pattern that finds nothing, a run that lacks a file, a name that two files have; [`Error::File`] for
/// an index table that cannot be read.
pub fn plan(mapping: &Mapping, folder: &Path, file: &str) -> Result<Vec<PlannedRun>, Error> {
    let wrong = |key: String, found: String, expected: String| Error::Key {
        file: file.to_string(),
        key,
        found,
        expected,
    };
    let mut files: BTreeMap<String, BTreeMap<String, PathBuf>> = BTreeMap::new();
    for (name, logger) in &mapping.logger {
        let Some(pattern) = &logger.files else {
            continue;
        };
        let key = format!("logger.{name}.files");
        let found = matching(folder, pattern)
            .map_err(|expected| wrong(key.clone(), pattern.clone(), expected))?;
        for (run, path) in found {
            plain_name(&run).ok_or_else(|| {
                let expected =
                    "a file whose name can name a run: letters, digits, '-', '_' and '.'";
                wrong(
                    key.clone(),
                    path.display().to_string(),
                    expected.to_string(),
                )
            })?;
            files.entry(run).or_default().insert(name.clone(), path);
        }
    }
    for run in &mapping.run {
        let own = files.entry(run.name.clone()).or_default();
        own.extend(
            run.files
                .iter()
                .map(|(logger, path)| (logger.clone(), folder.join(path))),
        );
    }
    let table = match &mapping.index.table {
        None => Vec::new(),
        Some(path) => {
            let path = folder.join(path);
            read_table(&bytes_of(&path)?, &path.display().to_string())?
        }
    };
    let runs: Result<Vec<PlannedRun>, Error> = files
        .into_iter()
        .map(|(name, files)| {
            let lacking = mapping
                .logger
                .keys()
                .find(|logger| !files.contains_key(*logger));
            if let Some(logger) = lacking {
                let there: Vec<String> = files
                    .values()
                    .map(|path| path.display().to_string())
                    .collect();
                return Err(wrong(
                    format!("logger.{logger}.files"),
                    format!("no file of run {name}"),
                    format!(
                        "one beside {}, or files.{logger} in a table [[run]]",
                        there.join(", ")
                    ),
                ));
            }
            let own = mapping.run.iter().find(|run| run.name == name);
            let row = table
                .iter()
                .find(|(run, _)| *run == name)
                .map(|(_, values)| values);
            let index = mapping.index.below(row.unwrap_or(&IndexValues::default()));
            Ok(PlannedRun {
                index: index.below(own.map_or(&IndexValues::default(), |run| &run.index)),
                delay_s: own.map(|run| run.delay_s.clone()).unwrap_or_default(),
                name,
                files,
            })
        })
        .collect();
    let runs = runs?;
    if runs.is_empty() {
        return Err(wrong(
            "run".into(),
            "no run".into(),
            "logger.NAME.files or a table [[run]]".into(),
        ));
    }
    for (name, _) in &table {
        if !runs.iter().any(|run| run.name == *name) {
            let known: Vec<&str> = runs.iter().map(|run| run.name.as_str()).take(60).collect();
            return Err(wrong(
                "index.table".into(),
                format!("a row of run {name:?}"),
                format!("one of: {}", known.join(", ")),
            ));
        }
    }
    Ok(runs)
}

/// Files that a pattern names, with what its `*` stands for, or with the file's own name where it has none; by name.
///
/// # Errors
/// What was expected.
fn matching(folder: &Path, pattern: &str) -> Result<Vec<(String, PathBuf)>, String> {
    let whole = folder.join(pattern);
    let last = whole
        .file_name()
        .map(|name| name.to_string_lossy().to_string())
        .unwrap_or_default();
    let parent = whole.parent().unwrap_or(Path::new("")).to_path_buf();
    let Some((before, after)) = last.split_once('*') else {
        let stem = whole
            .file_stem()
            .map(|stem| stem.to_string_lossy().to_string())
            .unwrap_or_default();
        return Ok(vec![(stem, whole)]);
    };
    if after.contains('*') || parent.to_string_lossy().contains('*') {
        return Err("one '*', in the last part of the path".to_string());
    }
    let shown = match parent.as_os_str().is_empty() {
        true => Path::new("."),
        false => &parent,
    };
    let entries = std::fs::read_dir(shown)
        .map_err(|error| format!("a folder {}: {error}", shown.display()))?;
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().to_string();
        let run = name
            .strip_prefix(before)
            .and_then(|rest| rest.strip_suffix(after));
        if let Some(run) = run.filter(|run| !run.is_empty() && !name.starts_with('.')) {
            found.push((run.to_string(), parent.join(&name)));
        }
    }
    found.sort();
    if found.is_empty() {
        return Err(format!("files of that pattern in {}", shown.display()));
    }
    Ok(found)
}
