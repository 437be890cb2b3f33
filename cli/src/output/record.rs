//! The record, in an output folder, of the files that commands wrote there.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use kufe::jobs::field::is_plain;
use kufe::jobs::{Failure, Located};
use kufe_files::{sha256_of_file, temporary_in};
use serde::{Deserialize, Serialize};

/// The file of an output folder that records which command wrote which files there.
pub const RECORD: &str = ".kufe.json";
/// The index of runs, which names other files of its folder.
pub const INDEX: &str = "runs.csv";

/// Whether readers of a folder open this file first.
fn is_document(name: &str) -> bool {
    name == INDEX || name.ends_with(".json")
}

/// Which command wrote a folder, and which commands wrote which files in it.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub struct FolderRecord {
    version: String,
    /// The command that made the folder; none for a folder of the user into which commands wrote
    /// single files.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    files: BTreeMap<String, FileRecord>,
}

/// One file of a folder.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub struct FileRecord {
    command: String,
    /// SHA-256 of the file; while the file is being replaced, those of the new and the old one.
    sha256: Vec<String>,
}

impl FileRecord {
    /// Whether a file is unchanged since it was written.
    pub fn describes(&self, path: &Path) -> bool {
        hash(path).is_some_and(|found| self.sha256.contains(&found))
    }
}

/// SHA-256 of a regular file; `None` for links and anything else.
fn hash(path: &Path) -> Option<String> {
    let is_file = path.symlink_metadata().is_ok_and(|found| found.is_file());
    let file = is_file.then(|| File::open(path).ok()).flatten()?;
    sha256_of_file(&file).ok()
}

impl FolderRecord {
    /// The record of a folder without files.
    pub fn new(command: Option<&str>) -> FolderRecord {
        FolderRecord {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.map(str::to_owned),
            files: BTreeMap::new(),
        }
    }

    /// The record of `folder`; `None` if there is no valid one.
    pub fn read(folder: &Path) -> Option<FolderRecord> {
        let path = folder.join(RECORD);
        if path.is_symlink() {
            return None;
        }
        let text = kufe_files::text_of_regular(&path, 1 << 24).ok()?;
        let mut record: FolderRecord = serde_json::from_str(&text).ok()?;
        // A record that kufe did not write may name files outside the folder.
        record.files.retain(|name, _| is_plain(name));
        Some(record)
    }

    /// Writes the record into its folder.
    ///
    /// # Errors
    /// The error of the operating system if the record cannot be written.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        let file = temporary_in(folder)?;
        serde_json::to_writer(&file, self)?;
        file.persist(folder.join(RECORD))?;
        Ok(())
    }

    /// The files that any of these commands wrote.
    pub fn files_of(&self, commands: &[&str]) -> impl Iterator<Item = &String> {
        let files = self.files.iter();
        let files = files.filter(|(_, file)| commands.contains(&&*file.command));
        files.map(|(name, _)| name)
    }

    /// Why the file `name` of `folder` may only be replaced with `--force`; none if it does not
    /// exist or is unchanged since one of `commands` wrote it.
    pub fn refusal(&self, folder: &Path, name: &str, commands: &[&str]) -> Option<String> {
        let path = folder.join(name);
        path.symlink_metadata().ok()?;
        let reason = match self.files.get(name) {
            None => "it exists already, and kufe did not write it".to_owned(),
            Some(file) if !file.describes(&path) => {
                "it exists already, and was changed since kufe wrote it".to_owned()
            }
            Some(file) if commands.contains(&&*file.command) => return None,
            Some(file) => format!("kufe {} wrote it", file.command),
        };
        Some(reason + "; --force replaces it")
    }

    /// The command that wrote the file `name` of `folder`; none if the file has changed since.
    pub fn writer_of(folder: &Path, name: &str) -> Option<String> {
        let record = FolderRecord::read(folder)?;
        let file = record.files.get(name)?;
        file.describes(&folder.join(name))
            .then(|| file.command.clone())
    }

    /// Moves the files `names` from `hidden` into `folder`, to which this record belongs, and
    /// removes the files `stale` of an earlier run.
    ///
    /// Old documents are removed first and new ones moved last. If the process is killed between
    /// two files, readers therefore find no result, rather than a mixture of two runs. A single
    /// file is replaced in one step.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path that cannot be replaced.
    pub fn replace(
        mut self,
        folder: &Path,
        hidden: &Path,
        names: &[String],
        stale: &[String],
        command: &str,
    ) -> Result<(), Failure> {
        let mut names = names.to_vec();
        names.sort_by_key(|name| (is_document(name), name == INDEX));
        // Until the last file is moved, both the old and the new files are in the record.
        for name in &names {
            let before = self.files.remove(name).map(|file| file.sha256);
            let hashes = hash(&hidden.join(name)).into_iter();
            let file = FileRecord {
                command: command.to_owned(),
                sha256: hashes.chain(before.into_iter().flatten()).collect(),
            };
            self.files.insert(name.clone(), file);
        }
        // In a folder of the user the record may be missing: the files are then replaced only with
        // `--force`.
        let is_users = self.command.is_none();
        let record = |record: &FolderRecord| match record.write(folder) {
            Err(error) if !is_users => Err(Failure::unwritable(folder, error)),
            _ => Ok(()),
        };
        record(&self)?;
        let are_several = names.len() + stale.len() > 1;
        // The index is removed first, so that all files that it names exist.
        let documents = names.iter().rev();
        let documents = documents.filter(|name| are_several && is_document(name));
        for path in documents.chain(stale).map(|name| folder.join(name)) {
            if path.symlink_metadata().is_ok() {
                std::fs::remove_file(&path).writable(&path)?;
            }
        }
        for name in &names {
            let to = folder.join(name);
            let moved = std::fs::rename(hidden.join(name), &to);
            moved.writable(&to)?;
            let written = self.files.get_mut(name);
            written.into_iter().for_each(|file| file.sha256.truncate(1));
        }
        self.files.retain(|name, _| !stale.contains(name));
        record(&self)
    }
}

/// Removes the files that kufe wrote into `folder` and that are unchanged, then the folder if it is
/// empty.
pub fn remove_outputs(folder: &Path) {
    let record = FolderRecord::read(folder).filter(|_| !folder.is_symlink());
    let Some(record) = record else {
        return;
    };
    for (name, file) in &record.files {
        if file.describes(&folder.join(name)) {
            let _ = std::fs::remove_file(folder.join(name));
        }
    }
    let _ = std::fs::remove_file(folder.join(RECORD));
    let _ = std::fs::remove_dir(folder);
}

/// Locks a folder; other processes of kufe wait for the lock. None if the operating system does not
/// support it.
pub fn lock(folder: &Path) -> Option<File> {
    let file = File::open(folder).ok()?;
    file.lock().ok()?;
    Some(file)
}
