//! Output folders, which receive all files of a command or none.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::fs::File;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::field::{NewFiles, is_plain};
use kufe::plot::Figure;
use kufe_files::{outputs_apart, resolved, sha256_of_file};
use serde::{Deserialize, Serialize};

use crate::output::{Staging, TEMPORARY, remove_on_interrupt, unwritable};

/// The file of an output folder that records which command wrote which files there.
const RECORD: &str = ".kufe.json";
/// The index of runs, which names other files of its folder.
const INDEX: &str = "runs.csv";

/// Which command wrote a folder, and which commands wrote which files in it.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub struct FolderRecord {
    version: String,
    /// The command whose output the folder is; none where the folder is the user's, with single
    /// files of commands in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    command: Option<String>,
    files: BTreeMap<String, FileRecord>,
}

/// One file of a folder.
#[derive(Serialize, Deserialize, Clone, Debug)]
struct FileRecord {
    command: String,
    /// SHA-256 of its bytes; that of the earlier file too while this one takes its place.
    sha256: Vec<String>,
}

impl FileRecord {
    /// Whether a file is as it was written.
    fn describes(&self, path: &Path) -> bool {
        hash(path).is_some_and(|found| self.sha256.contains(&found))
    }
}

/// SHA-256 of a file; `None` for links and what is no file.
pub(super) fn hash(path: &Path) -> Option<String> {
    let is_file = path.symlink_metadata().is_ok_and(|found| found.is_file());
    let file = is_file.then(|| File::open(path).ok()).flatten()?;
    sha256_of_file(&file).ok()
}

impl FolderRecord {
    /// The record of a folder without files.
    fn new(command: Option<&str>) -> FolderRecord {
        FolderRecord {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.map(str::to_owned),
            files: BTreeMap::new(),
        }
    }

    /// The record of `folder`; `None` where kufe did not write that folder.
    fn read(folder: &Path) -> Option<FolderRecord> {
        let path = folder.join(RECORD);
        if path.is_symlink() {
            return None;
        }
        let text = kufe_files::text_of_regular(&path, 1 << 24).ok()?;
        let mut record: FolderRecord = serde_json::from_str(&text).ok()?;
        // A record from elsewhere may name files outside its folder.
        record.files.retain(|name, _| is_plain(name));
        Some(record)
    }

    fn write(&self, folder: &Path) -> std::io::Result<()> {
        let file = tempfile::Builder::new()
            .prefix(TEMPORARY)
            .tempfile_in(folder)?;
        serde_json::to_writer(&file, self)?;
        file.persist(folder.join(RECORD))?;
        Ok(())
    }

    /// The files that `command` wrote, and pages that show them; other commands may have added
    /// theirs.
    fn files_of(&self, command: &str) -> impl Iterator<Item = (&String, &FileRecord)> {
        let files = self.files.iter();
        files.filter(move |(_, file)| file.command == command || file.command == "report")
    }

    /// The command that wrote the file `name` of `folder`, where the file is as it was written.
    pub fn writer_of(folder: &Path, name: &str) -> Option<String> {
        let record = FolderRecord::read(folder)?;
        let file = record.files.get(name)?;
        file.describes(&folder.join(name))
            .then(|| file.command.clone())
    }

    /// Adds files with their SHA-256, which `command` writes into `folder`, to the folder's record.
    ///
    /// Where the record cannot be written, the files are only replaced with `--force`.
    pub fn add(folder: &Path, files: impl Iterator<Item = (String, String)>, command: &str) {
        let record = FolderRecord::read(folder);
        let mut record = record.unwrap_or_else(|| FolderRecord::new(None));
        record.files.extend(files.map(|(name, hash)| {
            let file = FileRecord {
                command: command.to_owned(),
                sha256: vec![hash],
            };
            (name, file)
        }));
        let _ = record.write(folder);
    }
}

/// A temporary folder that collects files until [`OutputDir::commit`] moves them into the output.
///
/// It is made before the work starts, so that an output that cannot be written fails at once.
/// Without a commit it is removed, and so are the folders that had to be made.
///
/// The output folder is new, empty, or one that the same command wrote before. `--force` permits
/// any other folder. An input of the command is never replaced.
pub struct OutputDir {
    command: &'static str,
    /// The folder, as the user names it.
    named: PathBuf,
    /// The folder, without links.
    target: PathBuf,
    inputs: Vec<PathBuf>,
    force: bool,
    staging: Staging,
}

impl OutputDir {
    /// Prepares `target` as the output of `command`, which reads `inputs`.
    ///
    /// An interrupt removes the temporary folder and ends the process with code 130.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the folder is not empty and not an earlier output of `command`,
    /// or cannot be written.
    pub fn begin(
        command: &'static str,
        inputs: &[PathBuf],
        target: &Path,
        force: bool,
    ) -> Result<OutputDir, Failure> {
        let output = OutputDir::prepare(command, inputs, target, force)?;
        let Staging { hidden, made } = &output.staging;
        remove_on_interrupt([hidden], std::slice::from_ref(made));
        Ok(output)
    }

    /// As [`OutputDir::begin`], for a command that handles interrupts itself.
    ///
    /// # Errors
    /// As [`OutputDir::begin`].
    pub fn prepare(
        command: &'static str,
        inputs: &[PathBuf],
        target: &Path,
        force: bool,
    ) -> Result<OutputDir, Failure> {
        let named = target.to_path_buf();
        let target = resolved(target);
        let staging = Staging::in_folder(&target).map_err(|error| unwritable(&named, &error))?;
        let output = OutputDir {
            command,
            inputs: inputs.to_vec(),
            force,
            staging,
            named,
            target,
        };
        kufe_files::clear_temporaries(&output.target);
        output.check(&[])?;
        Ok(output)
    }

    /// Records the folder as this command's before anything is in it, so that it can resume there.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the record cannot be written.
    pub fn record(&self) -> Result<(), Failure> {
        let _lock = lock(&self.target);
        let record = self.check(&[])?;
        record
            .write(&self.target)
            .map_err(|error| unwritable(&self.named, &error))
    }

    /// Checks that the folder may receive files of these names; returns the record of those that
    /// an earlier run of the command wrote there.
    fn check(&self, names: &[String]) -> Result<FolderRecord, Failure> {
        let own = match FolderRecord::read(&self.target) {
            Some(record) if record.command.as_deref() == Some(self.command) => record,
            found => {
                let owner = found.and_then(|record| record.command);
                if let Some(reason) = self.foreign(owner)?.filter(|_| !self.force) {
                    let place = self.named.display();
                    return Err(Failure::BadInput(format!(
                        "{place}: {reason}; expected another folder, or --force"
                    )));
                }
                FolderRecord::new(Some(self.command))
            }
        };
        let failure = |name: &str, reason: &str| Err(unwritable(&self.named.join(name), &reason));
        let inputs: BTreeSet<PathBuf> = self.inputs.iter().map(|path| resolved(path)).collect();
        for (name, file) in own.files_of(self.command) {
            let path = self.target.join(name);
            if inputs.contains(&resolved(&path)) {
                return failure(name, "this command reads it; expected another folder");
            }
            if !self.force && path.symlink_metadata().is_ok() && !file.describes(&path) {
                return failure(
                    name,
                    "it was changed since kufe wrote it; --force replaces it",
                );
            }
        }
        let paths: Vec<PathBuf> = names.iter().map(|name| self.named.join(name)).collect();
        if let Some((name, _)) = names.iter().zip(&paths).find(|(_, path)| path.is_symlink()) {
            return failure(name, "a link is in the way; expected another folder");
        }
        outputs_apart(&self.inputs, &paths).map_err(Failure::bad_input)?;
        for (name, path) in names.iter().zip(&paths) {
            let is_own = own.files_of(self.command).any(|(one, _)| one == name);
            if path.exists() && !self.force && !is_own {
                return failure(
                    name,
                    "it exists and kufe did not write it; --force replaces it",
                );
            }
        }
        Ok(own)
    }

    /// Why the folder, of the command `owner`, is not this command's; `None` for an empty one.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a folder that cannot be read.
    fn foreign(&self, owner: Option<String>) -> Result<Option<String>, Failure> {
        if let Some(owner) = owner {
            return Ok(Some(format!("it contains results of kufe {owner}")));
        }
        let failure = |error: std::io::Error| unwritable(&self.named, &error);
        for entry in std::fs::read_dir(&self.target).map_err(failure)? {
            let name = entry.map_err(failure)?.file_name();
            let name = name.to_string_lossy();
            if !name.starts_with(TEMPORARY) && name != RECORD {
                return Ok(Some(format!(
                    "it is not empty and kufe {} did not write it ({name})",
                    self.command
                )));
            }
        }
        Ok(None)
    }

    /// Writes the file `name` with a function that takes the file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path of the output where the file cannot be written, its name
    /// is not plain, or it was written before.
    pub fn write<E: Display>(
        &self,
        name: &str,
        write: impl FnOnce(&File) -> Result<(), E>,
    ) -> Result<(), Failure> {
        self.files().write(name, write)
    }

    /// Writes a picture.
    ///
    /// # Errors
    /// As [`OutputDir::write`].
    pub fn picture(&self, name: &str, figure: &Figure) -> Result<(), Failure> {
        self.files().picture(name, figure)
    }

    /// The files before they are moved, for a library to write.
    pub fn files(&self) -> NewFiles<'_> {
        NewFiles {
            hidden: self.staging.hidden.path(),
            named: &self.named,
        }
    }

    /// Writes one file of text.
    ///
    /// # Errors
    /// As [`OutputDir::write`].
    pub fn text(&self, name: &str, text: &str) -> Result<(), Failure> {
        self.write(name, |mut file| {
            std::io::Write::write_all(&mut file, text.as_bytes())
        })
    }

    /// Writes a result as JSON.
    ///
    /// # Errors
    /// As [`OutputDir::write`].
    pub fn json(&self, name: &str, result: &impl Serialize) -> Result<(), Failure> {
        self.files().json(name, result)
    }

    /// Moves every file into the output folder and removes those of an earlier run of the command.
    ///
    /// An index of runs is removed first and moved last: what it names is always complete.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path that could not be replaced.
    pub fn commit(self) -> Result<(), Failure> {
        let failure = |error: std::io::Error| unwritable(&self.named, &error);
        let _lock = lock(&self.target);
        let mut names = Vec::new();
        for entry in std::fs::read_dir(self.staging.hidden.path()).map_err(failure)? {
            let name = entry.map_err(failure)?.file_name();
            names.push(name.to_string_lossy().into_owned());
        }
        names.sort_by_key(|name| name == INDEX);
        let mut record = self.check(&names)?;
        let own = record.files_of(self.command).map(|(name, _)| name);
        let stale: Vec<String> = own.filter(|name| !names.contains(name)).cloned().collect();
        // Both sets of files are kufe's until the last is moved.
        for name in &names {
            let new = hash(&self.staging.hidden.path().join(name));
            let before = record.files.remove(name).map(|file| file.sha256);
            let file = FileRecord {
                command: self.command.to_owned(),
                sha256: new
                    .into_iter()
                    .chain(before.into_iter().flatten())
                    .collect(),
            };
            record.files.insert(name.clone(), file);
        }
        record.write(&self.target).map_err(failure)?;
        let index = names.iter().filter(|name| *name == INDEX);
        for name in index.chain(&stale) {
            let path = self.target.join(name);
            if path.symlink_metadata().is_ok() {
                std::fs::remove_file(&path).map_err(|error| unwritable(&path, &error))?;
            }
        }
        for name in &names {
            let to = self.target.join(name);
            std::fs::rename(self.staging.hidden.path().join(name), &to)
                .map_err(|error| unwritable(&to, &error))?;
        }
        for name in &names {
            let written = record.files.get_mut(name);
            written.into_iter().for_each(|file| file.sha256.truncate(1));
        }
        record.files.retain(|name, _| !stale.contains(name));
        record.write(&self.target).map_err(failure)
    }
}

/// Removes the files that kufe wrote into `folder` and that nobody changed, and then the folder,
/// if nothing else is in it.
pub fn remove_outputs(folder: &Path) {
    if folder.is_symlink() {
        return;
    }
    let Some(record) = FolderRecord::read(folder) else {
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

/// A lock on a folder, which other processes of kufe wait for; none where the system has no such.
pub(super) fn lock(folder: &Path) -> Option<File> {
    let file = File::open(folder).ok()?;
    file.lock().ok()?;
    Some(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::OutputFiles;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    /// Writes files of these names, each with its name as content.
    fn write_all(folder: &Path, force: bool, names: &[&str]) -> Result<(), Failure> {
        let output = OutputDir::prepare("press", &[], folder, force)?;
        for name in names {
            output.text(name, name)?;
        }
        output.commit()
    }

    /// The reason why files of these names are refused.
    fn refusal(folder: &Path, names: &[&str]) -> String {
        let failure = write_all(folder, false, names).expect_err("it is refused");
        failure.to_string()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<String> = names.map(|n| n.to_string_lossy().into_owned()).collect();
        names.retain(|name| name != RECORD);
        names.sort();
        names
    }

    #[test]
    fn files_of_other_commands_stay_whatever_a_user_made_of_them() -> Outcome {
        let root = tempfile::tempdir()?;
        let out = root.path().join("out");
        write_all(&out, false, &["x", "y"])?;
        let case = out.join("case.toml");
        let files = OutputFiles::begin("init", &[], std::slice::from_ref(&case), false)?;
        files.write(&case, |writer| writer.write_all(b"a case"))?;
        files.commit()?;
        std::fs::write(&case, "a case of the user's own")?;
        for force in [false, true] {
            let inputs = [case.clone()];
            let output = OutputDir::prepare("press", &inputs, &out, force)?;
            output.text("x", "x")?;
            output.commit()?;
            assert_eq!(names(&out), ["case.toml", "x"]);
            assert_eq!(std::fs::read_to_string(&case)?, "a case of the user's own");
        }
        Ok(())
    }

    #[test]
    fn a_folder_receives_all_files_or_none() -> Outcome {
        let root = tempfile::tempdir()?;
        let out = root.path().join("a/b");
        let output = OutputDir::prepare("press", &[], &out, false)?;
        output.text("half", "half")?;
        assert!(!out.join("half").exists());
        drop(output);
        assert!(!root.path().join("a").exists());
        write_all(&out, false, &["x", "y"])?;
        assert_eq!(names(&out), ["x", "y"]);
        write_all(&out, false, &["x"])?;
        assert_eq!(names(&out), ["x"]);
        remove_outputs(&out);
        assert!(!out.exists());
        Ok(())
    }

    #[test]
    fn foreign_and_changed_files_are_replaced_with_force_alone() -> Outcome {
        let root = tempfile::tempdir()?;
        let out = root.path().join("out");
        std::fs::create_dir(&out)?;
        std::fs::write(out.join("notes"), "mine")?;
        assert!(refusal(&out, &["x"]).contains("not empty"));
        write_all(&out, true, &["x"])?;
        write_all(&out, false, &["x"])?;
        assert_eq!(names(&out), ["notes", "x"]);
        assert!(refusal(&out, &["notes"]).contains("did not write it"));
        std::fs::write(out.join("x"), "changed")?;
        assert!(refusal(&out, &["x"]).contains("it was changed"));
        write_all(&out, true, &["x"])?;
        let other = OutputDir::prepare("mesh", &[], &out, false).map(|_| ());
        assert!(
            other
                .unwrap_err()
                .to_string()
                .contains("results of kufe press")
        );
        let read = OutputDir::prepare("press", &[out.join("x")], &out, true).map(|_| ());
        assert!(read.unwrap_err().to_string().contains("reads it"));
        Ok(())
    }

    #[test]
    fn names_that_are_not_plain_are_refused() -> Outcome {
        let root = tempfile::tempdir()?;
        let out = root.path().join("out");
        for name in [
            "", "..", ".hidden", "../x", "/x", "a/b", "a\\b", "a:b", "a\nb",
        ] {
            let reason = write_all(&out, true, &[name]).expect_err(name).to_string();
            assert!(reason.contains("plain name"), "{reason}");
        }
        assert!(refusal(&out, &["x", "x"]).contains("cannot be written"));
        Ok(())
    }

    #[test]
    fn equal_commands_at_once_all_end_well() -> Outcome {
        let root = tempfile::tempdir()?;
        let out = root.path().join("a/b");
        for _ in 0..5 {
            std::thread::scope(|scope| {
                let start = |_| scope.spawn(|| write_all(&out, false, &["x", INDEX]));
                let started: Vec<_> = (0..6).map(start).collect();
                for one in started {
                    one.join().expect("no panic").expect("written");
                }
            });
            assert_eq!(names(&out), [INDEX, "x"]);
            std::fs::remove_dir_all(root.path().join("a"))?;
        }
        Ok(())
    }
}
