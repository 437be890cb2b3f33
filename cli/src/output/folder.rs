//! Output folders, which receive all files of a command or none.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::File;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::field::NewFiles;
use kufe::plot::Figure;
use kufe_files::{outputs_apart, resolved};
use serde::Serialize;

use crate::output::record::{FolderRecord, RECORD, lock};
use crate::output::{Staging, TEMPORARY, names_in, remove_on_interrupt};

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
        let staging =
            Staging::in_folder(&target).map_err(|error| Failure::unwritable(&named, error))?;
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
            .map_err(|error| Failure::unwritable(&self.named, error))
    }

    /// Checks that the folder may receive files of these names; returns the record of those that
    /// an earlier run of the command wrote there.
    fn check(&self, names: &[String]) -> Result<FolderRecord, Failure> {
        let found = FolderRecord::read(&self.target);
        let owner = found.as_ref().and_then(|record| record.command.clone());
        let own = match found {
            Some(record) if owner.as_deref() == Some(self.command) => record,
            _ => {
                if let Some(reason) = self.foreign(owner)?.filter(|_| !self.force) {
                    let reason = format!("{reason}; expected another folder, or --force");
                    return Err(Failure::in_file(&self.named, reason));
                }
                FolderRecord::new(Some(self.command))
            }
        };
        let failure =
            |name: &str, reason: &str| Err(Failure::unwritable(&self.named.join(name), reason));
        let inputs: BTreeSet<PathBuf> = self.inputs.iter().map(|path| resolved(path)).collect();
        for (name, file) in own.files_of(self.command) {
            let path = self.target.join(name);
            if inputs.contains(&resolved(&path)) {
                return failure(name, "this command reads it; expected another folder");
            }
            if !self.force && path.symlink_metadata().is_ok() && !file.describes(&path) {
                let reason = "it was changed since kufe wrote it; --force replaces it";
                return failure(name, reason);
            }
        }
        let paths: Vec<PathBuf> = names.iter().map(|name| self.named.join(name)).collect();
        if let Some((name, _)) = names.iter().zip(&paths).find(|(_, path)| path.is_symlink()) {
            return failure(name, "a link is in the way; expected another folder");
        }
        outputs_apart(&self.inputs, &paths).map_err(Failure::bad_input)?;
        for (name, path) in names.iter().zip(&paths).filter(|_| !self.force) {
            if path.exists() && own.files_of(self.command).all(|(one, _)| one != name) {
                let reason = "it exists and kufe did not write it; --force replaces it";
                return failure(name, reason);
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
        let names =
            names_in(&self.target).map_err(|error| Failure::unwritable(&self.named, error))?;
        let mut names = names.iter();
        let other = names.find(|name| !name.starts_with(TEMPORARY) && *name != RECORD);
        let command = self.command;
        Ok(other
            .map(|name| format!("it is not empty and kufe {command} did not write it ({name})")))
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
        self.files().bytes(name, text.as_bytes())
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
    /// # Errors
    /// [`Failure::BadInput`] with the path that could not be replaced.
    pub fn commit(self) -> Result<(), Failure> {
        let hidden = self.staging.hidden.path();
        let _lock = lock(&self.target);
        let names = names_in(hidden).map_err(|error| Failure::unwritable(&self.named, error))?;
        let record = self.check(&names)?;
        let own = record.files_of(self.command).map(|(name, _)| name);
        let stale: Vec<String> = own.filter(|name| !names.contains(name)).cloned().collect();
        record.replace(&self.target, hidden, names, &stale, self.command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::OutputFiles;
    use crate::output::record::{INDEX, remove_outputs};

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
