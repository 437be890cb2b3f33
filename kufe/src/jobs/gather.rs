//! The runs of several folders, indices and files, brought together.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use kufe_files::{leads_out, resolved, same_file};
use kufe_sled::{Entry, read_columns, read_index, track_file};

use crate::jobs::failure::Failure;

/// The name in an index of what is not stated.
pub const UNNAMED: &str = "unnamed";

/// The columns that every run has.
const OF_A_RUN: [&str; 2] = ["t_s", "v_mps"];

/// Runs of several folders.
#[derive(Default)]
pub struct Gathered {
    /// Each file once.
    pub entries: Vec<Entry>,
    /// Files that are no runs, and runs that were named before, with the reason.
    pub passed_over: Vec<String>,
    /// New names of runs whose names several folders have.
    pub renamed: Vec<String>,
}

/// Reads indices, and files without an index, in the order given. A run whose name another folder's
/// run has gets its folder's name before its own.
///
/// # Errors
/// [`Failure::BadInput`] for a file that cannot be read, a folder without runs, a run's file that
/// does not exist, and for runs of one name in folders of one name.
pub fn gather(from: &[PathBuf]) -> Result<Gathered, Failure> {
    let mut all = Gathered::default();
    for path in from {
        if path.is_dir() {
            all.folder(path)?;
        } else {
            match kind(path)? {
                Kind::Index => all.index(path)?,
                Kind::Run => all.add(loose(path)),
                Kind::Other(reason) => return Err(wrong(path, &reason)),
            }
        }
    }
    all.renamed = with_own_names(&mut all.entries)?;
    Ok(all)
}

impl Gathered {
    fn folder(&mut self, folder: &Path) -> Result<(), Failure> {
        let index = folder.join("runs.csv");
        if index.is_file() {
            return self.index(&index);
        }
        let unreadable = |error: std::io::Error| wrong(folder, &format!("cannot be read: {error}"));
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            let ending = path
                .extension()
                .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
            if path.is_file() && ending.is_some_and(|e| ["csv", "parquet", "mat"].contains(&&*e)) {
                files.push(path);
            }
        }
        files.sort();
        let before = self.entries.len();
        for file in files {
            match kind(&file) {
                Ok(Kind::Run) => self.add(loose(&file)),
                Ok(Kind::Index) => self.index(&file)?,
                Ok(Kind::Other(reason)) => self
                    .passed_over
                    .push(format!("{}: {reason}", file.display())),
                Err(failure) => self.passed_over.push(failure.to_string()),
            }
        }
        if self.entries.len() == before {
            let reason = "no runs: expected runs.csv, or files with the columns t_s and v_mps";
            return Err(wrong(folder, reason));
        }
        Ok(())
    }

    fn index(&mut self, index: &Path) -> Result<(), Failure> {
        for entry in read_index(index)? {
            if !entry.file.is_file() {
                return Err(wrong(
                    index,
                    &format!("run {}: {}: no such file", entry.run, entry.file.display()),
                ));
            }
            self.add(entry);
        }
        Ok(())
    }

    fn add(&mut self, entry: Entry) {
        match self
            .entries
            .iter()
            .find(|known| same_file(&known.file, &entry.file))
        {
            Some(known) => self.passed_over.push(format!(
                "{}: it is run {} already",
                entry.file.display(),
                known.run
            )),
            None => self.entries.push(entry),
        }
    }
}

enum Kind {
    Index,
    Run,
    /// Neither; why.
    Other(String),
}

fn kind(path: &Path) -> Result<Kind, Failure> {
    let names: Vec<String> = if path.extension().is_some_and(|ending| ending == "csv") {
        let file = kufe_files::open_regular(path)
            .map_err(|error| wrong(path, &format!("cannot be read: {error}")))?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(std::io::Read::take(file, 1 << 16));
        let header = reader
            .headers()
            .map_err(|error| wrong(path, &error.to_string()))?;
        header.iter().map(str::to_owned).collect()
    } else {
        let columns = read_columns(path, &[])?;
        columns.into_keys().collect()
    };
    let has = |name: &&str| names.iter().any(|known| known == name);
    Ok(if ["run", "file"].iter().all(has) {
        Kind::Index
    } else if OF_A_RUN.iter().all(has) {
        Kind::Run
    } else {
        Kind::Other(format!(
            "no run: expected the columns {}",
            OF_A_RUN.join(" and ")
        ))
    })
}

/// Whether a file has the columns of a run.
///
/// # Errors
/// [`Failure::BadInput`] where it cannot be read.
pub fn is_run(path: &Path) -> Result<bool, Failure> {
    Ok(matches!(kind(path)?, Kind::Run))
}

/// A run without an index; its name is that of its file.
fn loose(file: &Path) -> Entry {
    let run = file.file_stem().unwrap_or_default().to_string_lossy();
    let unnamed = || UNNAMED.to_owned();
    Entry {
        run: run.into_owned(),
        file: file.to_path_buf(),
        track: unnamed(),
        driver: unnamed(),
        driver_class: unnamed(),
        session: unnamed(),
        ..Entry::default()
    }
}

fn wrong(path: &Path, reason: &str) -> Failure {
    Failure::BadInput(format!("{}: {reason}", path.display()))
}

/// Puts the folder's name before every run's whose name another folder's run has; returns the new
/// names.
fn with_own_names(entries: &mut [Entry]) -> Result<Vec<String>, Failure> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    for entry in entries.iter() {
        *count.entry(entry.run.clone()).or_default() += 1;
    }
    let mut renamed = Vec::new();
    for entry in entries.iter_mut().filter(|entry| count[&entry.run] > 1) {
        entry.run = format!("{}_{}", folder_of(&entry.file), entry.run);
        renamed.push(entry.run.clone());
    }
    let mut seen: BTreeMap<&str, &Entry> = BTreeMap::new();
    for entry in entries.iter() {
        if let Some(first) = seen.insert(&entry.run, entry) {
            return Err(Failure::BadInput(format!(
                "{}: run {:?} is {} too: expected names that differ, or folders whose names do",
                entry.file.display(),
                entry.run,
                first.file.display()
            )));
        }
    }
    Ok(renamed)
}

/// The name of the folder of a file.
pub fn folder_of(file: &Path) -> String {
    let whole = std::path::absolute(file).unwrap_or_else(|_| file.into());
    let folder = whole.parent().and_then(Path::file_name);
    folder.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// The tables of the runs' tracks, in the folders of the runs, that the index's folder does not
/// have yet: their names and contents.
///
/// # Errors
/// [`Failure::BadInput`] for tables of one track that differ.
pub fn track_tables(
    entries: &[Entry],
    folder: &Path,
) -> Result<BTreeMap<String, Vec<u8>>, Failure> {
    /// A track has some thousand rows [bytes].
    const LONGEST: u64 = 1 << 26;
    let mut tables: BTreeMap<String, (PathBuf, Vec<u8>)> = BTreeMap::new();
    for entry in entries {
        let name = track_file(&entry.track);
        for folder in [entry.file.parent().unwrap_or(Path::new("")), folder] {
            let path = folder.join(&name);
            if !path.is_file() {
                continue;
            }
            if leads_out(folder, &path) {
                return Err(wrong(&path, "a link that leads out of its folder"));
            }
            let bytes = kufe_files::read_regular(&path, LONGEST).map_err(|error| {
                Failure::BadInput(format!("{}: cannot be read: {error}", path.display()))
            })?;
            match tables.get(&name) {
                Some((first, known)) if *known != bytes => {
                    return Err(Failure::BadInput(format!(
                        "{}: another table of track {} than {}: expected one of each track",
                        path.display(),
                        entry.track,
                        first.display()
                    )));
                }
                Some(_) => {}
                None => {
                    tables.insert(name.clone(), (path, bytes));
                }
            }
        }
    }
    let missing = |(name, (path, bytes)): (String, (PathBuf, Vec<u8>))| {
        (!same_file(&path, &folder.join(&name)) && !folder.join(&name).exists())
            .then_some((name, bytes))
    };
    Ok(tables.into_iter().filter_map(missing).collect())
}

/// The path from a folder to a file.
pub fn relative(file: &Path, folder: &Path) -> PathBuf {
    let (file, folder) = (resolved(file), resolved(folder));
    let (file, folder): (Vec<_>, Vec<_>) =
        (file.components().collect(), folder.components().collect());
    let shared = file.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    let up = folder[shared..].iter().map(|_| Component::ParentDir);
    up.chain(file[shared..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_from_an_index_to_a_run_goes_up_and_down() {
        let way = |file: &str, folder: &str| relative(Path::new(file), Path::new(folder));
        assert_eq!(way("/a/b/run.csv", "/a"), Path::new("b/run.csv"));
        assert_eq!(way("/a/b/run.csv", "/a/c/d"), Path::new("../../b/run.csv"));
        assert_eq!(way("/a/run.csv", "/a"), Path::new("run.csv"));
    }
}
