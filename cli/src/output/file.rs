//! Single output files: all are written or none.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, Located};
use kufe_files::{outputs_apart, resolved};

use crate::output::record::{FolderRecord, lock};
use crate::output::{Staging, names_in, remove_on_interrupt};
use crate::terminal::Global;

/// Single output files of a command.
///
/// A file may be new, or an unchanged output of the same command; other files are only replaced
/// with `--force`. An input of the command is never replaced. [`OutputFiles::commit`] moves the
/// files to their final paths and adds them to the records of their folders.
pub struct OutputFiles {
    command: &'static str,
    inputs: Vec<PathBuf>,
    force: bool,
    /// Each output as the user names it, and its path with links resolved.
    outputs: Vec<(PathBuf, PathBuf)>,
    /// The folders that receive files, in reverse order: a folder may be within an earlier one.
    staged: Vec<(PathBuf, Staging)>,
}

impl OutputFiles {
    /// Prepares the outputs of `command`, which reads `inputs`.
    ///
    /// An interrupt removes the hidden folders and ends the process with code 130.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for an output that is an input, is named twice, cannot be written, or
    /// exists and is not the command's.
    pub fn begin(
        command: &'static str,
        inputs: &[PathBuf],
        outputs: &[PathBuf],
        force: bool,
    ) -> Result<OutputFiles, Failure> {
        let outputs = outputs.iter().map(|named| (named.clone(), resolved(named)));
        let mut files = OutputFiles {
            command,
            inputs: inputs.to_vec(),
            force,
            outputs: outputs.collect(),
            staged: Vec::new(),
        };
        files.check(|_| true)?;
        for (named, place) in &files.outputs {
            let folder = folder_of(place);
            if files.staged.iter().all(|(known, _)| known != folder) {
                let staging = Staging::in_folder(folder);
                let staging = staging.writable(named)?;
                files.staged.insert(0, (folder.to_path_buf(), staging));
            }
        }
        remove_on_interrupt(files.staged.iter().map(|(_, staging)| staging));
        Ok(files)
    }

    /// Temporary path of an output.
    fn new_file(&self, place: &Path) -> PathBuf {
        let mut staged = self.staged.iter();
        let own = staged.find(|(folder, _)| folder == folder_of(place));
        let (_, staging) = own.expect("every output's folder was prepared");
        staging.hidden.path().join(name_of(place))
    }

    /// Writes one of the outputs with a function that takes a writer.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with its path if it cannot be written.
    pub fn write<E: Display>(
        &self,
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let mut outputs = self.outputs.iter();
        let output = outputs.find(|(named, _)| named == path);
        let (_, place) = output.expect("an output that was stated at the beginning");
        let file = File::create(self.new_file(place)).writable(path)?;
        let mut writer = std::io::BufWriter::new(&file);
        write(&mut writer).writable(path)?;
        writer.flush().writable(path)?;
        drop(writer);
        file.sync_all().writable(path)
    }

    /// Writes one of the outputs.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn bytes(&self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        self.write(path, |writer| writer.write_all(bytes))
    }

    /// Moves the written files to their final paths.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with a path that has changed since the beginning.
    pub fn commit(self) -> Result<(), Failure> {
        // Locks are taken in sorted order in every process, which prevents deadlocks.
        let folders: BTreeSet<&PathBuf> = self.staged.iter().map(|(folder, _)| folder).collect();
        let _locks: Vec<_> = folders.into_iter().map(|folder| lock(folder)).collect();
        self.check(|place| self.new_file(place).exists())?;
        for (folder, staging) in &self.staged {
            let hidden = staging.hidden.path();
            let names = names_in(hidden).writable(folder)?;
            let record = FolderRecord::read(folder).unwrap_or_else(|| FolderRecord::new(None));
            record.replace(folder, hidden, &names, &[], self.command)?;
        }
        Ok(())
    }

    /// Checks that existing files at the paths of outputs may be replaced.
    fn check(&self, is_written: impl Fn(&Path) -> bool) -> Result<(), Failure> {
        let outputs = self.outputs.iter();
        let outputs: Vec<_> = outputs.filter(|(_, place)| is_written(place)).collect();
        let named: Vec<&PathBuf> = outputs.iter().map(|(named, _)| named).collect();
        outputs_apart(&self.inputs, &named).bad_input()?;
        for (named, place) in outputs {
            if resolved(named) != *place {
                return Err(Failure::unwritable(named, "it has become a link"));
            }
            if place.file_name().and_then(|name| name.to_str()).is_none() {
                return Err(Failure::unwritable(named, "expected a name in Unicode"));
            }
            let folder = folder_of(place);
            let record = FolderRecord::read(folder).unwrap_or_else(|| FolderRecord::new(None));
            let refusal = record.refusal(folder, &name_of(place), &[self.command]);
            if let Some(reason) = refusal.filter(|_| !self.force) {
                return Err(Failure::unwritable(named, reason));
            }
        }
        Ok(())
    }
}

/// Writes the only output of a command.
///
/// # Errors
/// As [`OutputFiles`].
pub fn write_file(
    command: &'static str,
    inputs: &[PathBuf],
    path: &Path,
    bytes: &[u8],
    global: &Global,
) -> Result<(), Failure> {
    let outputs = [path.to_path_buf()];
    let files = OutputFiles::begin(command, inputs, &outputs, global.force)?;
    files.bytes(path, bytes)?;
    files.commit()
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("/"))
}

fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::TEMPORARY;
    use crate::output::record::RECORD;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    /// Writes a file of a folder; `in` is read.
    fn write(folder: &Path, name: &str, text: &str, force: bool) -> Result<(), String> {
        let path = folder.join(name);
        let outputs = std::slice::from_ref(&path);
        let write = || {
            let files = OutputFiles::begin("lut", &[folder.join("in")], outputs, force)?;
            files.bytes(&path, text.as_bytes())?;
            files.commit()
        };
        write().map_err(|failure: Failure| failure.to_string())
    }

    #[test]
    fn a_file_that_exists_is_replaced_by_its_command_where_nobody_changed_it() -> Outcome {
        let root = tempfile::tempdir()?;
        let write = |name: &str, text: &str, force| write(root.path(), name, text, force);
        std::fs::write(root.path().join("in"), "read")?;
        write("a.csv", "1", false)?;
        write("a.csv", "2", false)?;
        write("new/b.csv", "3", false)?;
        // A change of one sign, with what kufe writes otherwise.
        for changed in ["3", "2\n", "# kufe 0.1.0\n2"] {
            std::fs::write(root.path().join("a.csv"), changed)?;
            for name in ["a.csv", "none/../a.csv"] {
                assert!(write(name, "2", false).unwrap_err().contains("--force"));
            }
            assert_eq!(std::fs::read_to_string(root.path().join("a.csv"))?, changed);
        }
        assert!(!root.path().join("none").exists());
        write("a.csv", "2", true)?;
        write("a.csv", "3", false)?;
        let other = OutputFiles::begin("report", &[], &[root.path().join("a.csv")], false);
        let refused = other.map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains("kufe lut wrote it"), "{refused}");
        for name in ["in", "./in", "none/../in"] {
            assert!(
                write(name, "x", true).unwrap_err().contains("reads it"),
                "{name}"
            );
        }
        let entries = std::fs::read_dir(root.path())?;
        let hidden = |name: &std::ffi::OsString| name.to_string_lossy().starts_with(TEMPORARY);
        assert!(!entries.flatten().any(|entry| hidden(&entry.file_name())));
        Ok(())
    }

    #[test]
    fn a_folder_whose_record_cannot_be_written_receives_files() -> Outcome {
        let root = tempfile::tempdir()?;
        std::fs::create_dir(root.path().join(RECORD))?;
        write(root.path(), "a.csv", "1", false)?;
        let refused = write(root.path(), "a.csv", "2", false).unwrap_err();
        assert!(refused.contains("--force"), "{refused}");
        write(root.path(), "a.csv", "2", true)?;
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_if_it_is_there_from_the_beginning() -> Outcome {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir()?;
        let at = |name: &str| root.path().join(name);
        std::fs::write(at("mine"), "mine")?;
        symlink("mine", at("link.csv"))?;
        symlink("nowhere", at("lost.csv"))?;
        assert!(write(root.path(), "link.csv", "x", false).is_err());
        assert!(
            write(root.path(), "lost.csv", "x", true)
                .unwrap_err()
                .contains("link")
        );
        let later = at("later.csv");
        let outputs = std::slice::from_ref(&later);
        let files = OutputFiles::begin("lut", &[], outputs, true)?;
        files.write(&later, |writer| writer.write_all(b"x"))?;
        symlink("mine", &later)?;
        assert!(files.commit().unwrap_err().to_string().contains("link"));
        assert_eq!(std::fs::read(at("mine"))?, b"mine");
        write(root.path(), "link.csv", "x", true)?;
        assert_eq!(std::fs::read(at("mine"))?, b"x");
        Ok(())
    }
}
