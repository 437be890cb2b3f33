//! One index of the runs of several folders, indices and files.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use kufe_files::{column_names, leads_out, resolved, same_file};
use kufe_sled::{Entry, read_columns, read_index, track_file};

use crate::jobs::failure::{Failure, Located};

/// Value in an index for a track, driver or session that is not stated.
pub const UNNAMED: &str = "unnamed";

const NO_RUN: &str = "no run: expected the columns t_s and v_mps";

/// Runs of several folders.
#[derive(Default)]
pub struct Gathered {
    /// The runs, each file once.
    pub entries: Vec<Entry>,
    /// Files that are not runs, and repeated runs, with the reason.
    pub passed_over: Vec<String>,
    /// New names of the runs whose names occurred more than once.
    pub renamed: Vec<String>,
}

/// Reads indices, and files without an index, in the order given. Run names that occur more than
/// once are prefixed with the name of their folder.
///
/// # Errors
/// [`Failure::BadInput`] for a file that cannot be read, a folder without runs, a run's file that
/// does not exist, and for runs of equal names in folders of equal names.
pub fn gather(from: &[PathBuf]) -> Result<Gathered, Failure> {
    let mut all = Gathered::default();
    for path in from {
        if path.is_dir() {
            all.folder(path)?;
        } else {
            match kind(path)? {
                Kind::Index => all.index(path)?,
                Kind::Run => all.add(unindexed(path)),
                Kind::Other => return Err(Failure::in_file(path, NO_RUN)),
            }
        }
    }
    all.renamed = make_names_unique(&mut all.entries)?;
    Ok(all)
}

impl Gathered {
    fn folder(&mut self, folder: &Path) -> Result<(), Failure> {
        let index = folder.join("runs.csv");
        if index.is_file() {
            return self.index(&index);
        }
        let mut files = Vec::new();
        for entry in folder.read_dir().readable(folder)? {
            let path = entry.readable(folder)?.path();
            let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
            let is_known = ["csv", "parquet", "mat"]
                .iter()
                .any(|known| ending == *known);
            files.extend(Some(path).filter(|path| is_known && path.is_file()));
        }
        files.sort();
        let before = self.entries.len();
        for file in files {
            match kind(&file) {
                Ok(Kind::Run) => self.add(unindexed(&file)),
                Ok(Kind::Index) => self.index(&file)?,
                Ok(Kind::Other) => {
                    let failure = Failure::in_file(&file, NO_RUN);
                    self.passed_over.push(failure.to_string());
                }
                Err(failure) => self.passed_over.push(failure.to_string()),
            }
        }
        if self.entries.len() == before {
            let reason = "no runs: expected runs.csv, or files with the columns t_s and v_mps";
            return Err(Failure::in_file(folder, reason));
        }
        Ok(())
    }

    fn index(&mut self, index: &Path) -> Result<(), Failure> {
        for entry in read_index(index)? {
            if !entry.file.is_file() {
                let (run, file) = (&entry.run, entry.file.display());
                let text = format_args!("run {run}: {file}: no such file");
                return Err(Failure::in_file(index, text));
            }
            self.add(entry);
        }
        Ok(())
    }

    fn add(&mut self, entry: Entry) {
        let mut known = self.entries.iter();
        match known.find(|known| same_file(&known.file, &entry.file)) {
            Some(known) => {
                let (file, run) = (entry.file.display(), &known.run);
                self.passed_over
                    .push(format!("{file}: it is run {run} already"));
            }
            None => self.entries.push(entry),
        }
    }
}

enum Kind {
    Index,
    Run,
    Other,
}

fn kind(path: &Path) -> Result<Kind, Failure> {
    let names: Vec<String> = if path.extension().is_some_and(|ending| ending == "csv") {
        let file = kufe_files::open_regular(path).in_file(path)?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(std::io::Read::take(file, 1 << 16));
        let header = reader.byte_headers().in_file(path)?;
        // Text of another encoding is another file.
        column_names(header.iter()).unwrap_or_default()
    } else {
        read_columns(path, &[])?.columns.into_keys().collect()
    };
    let has = |wanted: [&str; 2]| wanted.iter().all(|name| names.iter().any(|n| n == name));
    Ok(match (has(["run", "file"]), has(["t_s", "v_mps"])) {
        (true, _) => Kind::Index,
        (false, true) => Kind::Run,
        (false, false) => Kind::Other,
    })
}

/// Whether a file has the columns of a run.
///
/// # Errors
/// [`Failure::BadInput`] if it cannot be read.
pub fn is_run(path: &Path) -> Result<bool, Failure> {
    Ok(matches!(kind(path)?, Kind::Run))
}

/// A run without an index, named after its file.
fn unindexed(file: &Path) -> Entry {
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

/// Prefixes run names that occur more than once with the name of their folder; returns the new
/// names.
fn make_names_unique(entries: &mut [Entry]) -> Result<Vec<String>, Failure> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    for entry in entries.iter() {
        *count.entry(entry.run.clone()).or_default() += 1;
    }
    let mut renamed = Vec::new();
    for entry in entries.iter_mut().filter(|entry| count[&entry.run] > 1) {
        entry.run = format!("{}_{}", folder_of(&entry.file), entry.run);
        renamed.push(entry.run.clone());
    }
    let mut seen: BTreeMap<&str, &Path> = BTreeMap::new();
    for Entry { run, file, .. } in entries.iter() {
        if let Some(first) = seen.insert(run, file) {
            let first = first.display();
            let reason = format_args!(
                "run {run:?} is {first} too, in a folder of the same name: rename one of the runs or folders"
            );
            return Err(Failure::in_file(file, reason));
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

/// Names and contents of the track tables in the folders of the runs that `folder`, that of the
/// index, does not have yet.
///
/// # Errors
/// [`Failure::BadInput`] for tables of one track that differ.
pub fn track_tables(
    entries: &[Entry],
    folder: &Path,
) -> Result<BTreeMap<String, Vec<u8>>, Failure> {
    /// Largest size of a track table, which has some thousand rows [bytes].
    const MAX_BYTES: u64 = 1 << 26;
    let mut tables: BTreeMap<String, (PathBuf, Vec<u8>)> = BTreeMap::new();
    for entry in entries {
        let name = track_file(&entry.track);
        for folder in [entry.file.parent().unwrap_or(Path::new("")), folder] {
            let path = folder.join(&name);
            if !path.is_file() {
                continue;
            }
            if leads_out(folder, &path) {
                let reason = "a link that leads out of its folder";
                return Err(Failure::in_file(&path, reason));
            }
            let bytes = kufe_files::read_regular(&path, MAX_BYTES).in_file(&path)?;
            let known = tables.entry(name.clone());
            let (first, known) = known.or_insert_with(|| (path.clone(), bytes.clone()));
            if *known != bytes {
                let (track, first) = (&entry.track, first.display());
                let reason =
                    format_args!("differs from {first}: expected one table of track {track}");
                return Err(Failure::in_file(&path, reason));
            }
        }
    }
    tables.retain(|name, _| !folder.join(name).exists());
    let tables = tables.into_iter();
    Ok(tables.map(|(name, (_, bytes))| (name, bytes)).collect())
}

/// The relative path from a folder to a file.
pub fn relative(file: &Path, folder: &Path) -> PathBuf {
    let (file, folder) = (resolved(file), resolved(folder));
    let file: Vec<_> = file.components().collect();
    let folder: Vec<_> = folder.components().collect();
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
