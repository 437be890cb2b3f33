//! The runs of several folders, indices and files.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, runs::failure};
use kufe_files::same_file;
use kufe_sled::{Conditions, Entry, IceAlong, read_columns, read_index};

/// What an index says of a name that is not stated.
pub const UNNAMED: &str = "unnamed";

/// What a run has at least.
const OF_A_RUN: [&str; 2] = ["t_s", "v_mps"];

/// Runs, and what was found beside them.
pub struct Gathered {
    /// Each file once.
    pub entries: Vec<Entry>,
    /// Files that are no runs, and runs that were named before; why.
    pub passed_over: Vec<String>,
}

/// Reads indices, and files without an index, in the order given.
///
/// # Errors
/// [`Failure::BadInput`] for what cannot be read, a folder without runs, a run's file that is not there.
pub fn gathered(from: &[PathBuf]) -> Result<Gathered, Failure> {
    let mut all = Gathered {
        entries: Vec::new(),
        passed_over: Vec::new(),
    };
    for path in from {
        if path.is_dir() {
            all.folder(path)?;
        } else {
            match kind(path)? {
                Kind::Index => all.index(path)?,
                Kind::Run => all.add(loose(path)),
                Kind::Other(reason) => return Err(told(path, &reason)),
            }
        }
    }
    Ok(all)
}

impl Gathered {
    fn folder(&mut self, folder: &Path) -> Result<(), Failure> {
        let index = folder.join("runs.csv");
        if index.is_file() {
            return self.index(&index);
        }
        let unreadable = |error: std::io::Error| told(folder, &format!("cannot be read: {error}"));
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
        match self.entries.len() > before {
            true => Ok(()),
            false => Err(told(
                folder,
                "no runs: expected runs.csv, or files with the columns t_s and v_mps",
            )),
        }
    }

    fn index(&mut self, index: &Path) -> Result<(), Failure> {
        for entry in read_index(index).map_err(|error| failure(&error))? {
            if !entry.file.is_file() {
                return Err(told(
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
    /// What it is instead.
    Other(String),
}

fn kind(path: &Path) -> Result<Kind, Failure> {
    let names: Vec<String> = if path.extension().is_some_and(|ending| ending == "csv") {
        let file = kufe_files::open_regular(path)
            .map_err(|error| told(path, &format!("cannot be read: {error}")))?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(std::io::Read::take(file, 1 << 16));
        let header = reader
            .headers()
            .map_err(|error| told(path, &error.to_string()))?;
        header.iter().map(str::to_owned).collect()
    } else {
        let columns = read_columns(path, &[]).map_err(|error| failure(&error))?;
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

/// A run that no index states anything of; its file's name is its own.
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
        conditions: Conditions::UNSTATED,
        ice_along: IceAlong::default(),
        ice_of_track: IceAlong::default(),
    }
}

fn told(path: &Path, reason: &str) -> Failure {
    Failure::BadInput(format!("{}: {reason}", path.display()))
}
