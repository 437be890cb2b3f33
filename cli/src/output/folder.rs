//! Output folders: all files of a command are written or none.

use std::collections::BTreeSet;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use kufe::jobs::field::NewFiles;
use kufe::jobs::{Failure, Located};
use kufe_files::{outputs_apart, resolved};
use serde::Serialize;

use crate::output::record::{FolderRecord, RECORD, lock};
use crate::output::{Staging, TEMPORARY, names_in, remove_on_interrupt};
use crate::terminal::Global;

/// A temporary folder that collects files until [`OutputDir::commit`] moves them into the output.
///
/// It is created before the work starts, so that an output that cannot be written fails at once.
/// Without a commit it is removed, together with folders that were created for it.
///
/// The output folder is new, empty, or one that the same command wrote before. `--force` permits
/// any other folder. An input of the command is never replaced.
pub struct OutputDir {
    command: &'static str,
    /// The output folder with links resolved.
    target: PathBuf,
    inputs: Vec<PathBuf>,
    force: bool,
    staging: Staging,
    /// The files in the temporary folder, and the output folder as the user names it.
    files: NewFiles,
}

impl Deref for OutputDir {
    type Target = NewFiles;

    fn deref(&self) -> &NewFiles {
        &self.files
    }
}

impl OutputDir {
    /// Prepares `target` as the output of `command`, which reads `inputs`.
    ///
    /// An interrupt removes the temporary folder and ends the process with code 130.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the folder is not empty and not an earlier output of `command`,
    /// or cannot be written.
    pub fn begin(
        command: &'static str,
        inputs: &[PathBuf],
        target: &Path,
        force: bool,
    ) -> Result<OutputDir, Failure> {
        let output = OutputDir::prepare(command, inputs, target, force)?;
        remove_on_interrupt([&output.staging]);
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
        let place = resolved(target);
        if place.is_file() {
            return Err(Failure::in_file(target, "is a file, expected a folder"));
        }
        let staging = Staging::in_folder(&place).writable(target)?;
        let files = NewFiles {
            hidden: staging.hidden.path().to_path_buf(),
            named: target.to_path_buf(),
        };
        let output = OutputDir {
            command,
            target: place,
            inputs: inputs.to_vec(),
            force,
            staging,
            files,
        };
        output.check(&[])?;
        Ok(output)
    }

    /// Records the folder as an output of this command before it has files, so that the command can
    /// resume there.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the record cannot be written.
    pub fn record(&self) -> Result<(), Failure> {
        let _lock = lock(&self.target);
        let record = self.check(&[])?;
        record.write(&self.target).writable(&self.named)
    }

    /// The commands whose files this one replaces: itself, and `kufe report`, which makes pages of
    /// its files.
    fn replaced(&self) -> [&str; 2] {
        [self.command, "report"]
    }

    /// Checks that files of these names may replace those of an earlier run in the folder; returns
    /// the record of the folder.
    fn check(&self, names: &[String]) -> Result<FolderRecord, Failure> {
        // Listed before the record is read: another process records files before it moves them.
        let present = names_in(&self.target);
        let found = FolderRecord::read(&self.target);
        let owner = found.as_ref().and_then(|record| record.command.clone());
        let record = found.filter(|_| owner.as_deref() == Some(self.command));
        if record.is_none() && !self.force {
            let present = present.writable(&self.named)?;
            self.check_free(owner, &present)?;
        }
        let record = record.unwrap_or_else(|| FolderRecord::new(Some(self.command)));
        let commands = self.replaced();
        let own = record.files_of(&commands).map(String::as_str);
        let names: BTreeSet<&str> = own.chain(names.iter().map(String::as_str)).collect();
        let paths: Vec<PathBuf> = names.iter().map(|name| self.named.join(name)).collect();
        for (name, path) in names.iter().zip(&paths) {
            let refusal = record.refusal(&self.target, name, &commands);
            let link = path
                .is_symlink()
                .then(|| "a link is in the way; expected another folder".to_owned());
            if let Some(reason) = refusal.filter(|_| !self.force).or(link) {
                return Err(Failure::unwritable(path, reason));
            }
        }
        outputs_apart(&self.inputs, &paths).bad_input()?;
        Ok(record)
    }

    /// Refuses a folder of another command `owner`, and a folder of the user that is not empty.
    fn check_free(&self, owner: Option<String>, present: &[String]) -> Result<(), Failure> {
        let reason = if let Some(owner) = owner {
            format!("it contains results of kufe {owner}")
        } else {
            let is_other = |name: &&String| !name.starts_with(TEMPORARY) && *name != RECORD;
            let Some(name) = present.iter().find(is_other) else {
                return Ok(());
            };
            let command = self.command;
            format!("it is not empty and kufe {command} did not write it ({name})")
        };
        let reason = format!("{reason}; expected another folder, or --force");
        Err(Failure::in_file(&self.named, reason))
    }

    /// Writes the result of the command as the file `name`, moves all files into the output folder,
    /// and prints the result: as JSON, or as `text` and the names of the files.
    ///
    /// # Errors
    /// As [`OutputDir::write`] and [`OutputDir::commit`].
    pub fn finish(
        self,
        name: &str,
        result: &impl Serialize,
        global: &Global,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        self.json(name, result)?;
        let folder = self.named.clone();
        let written = self.commit()?;
        global.print(result, || text() + &listed(&folder, &written))
    }

    /// Moves every file into the output folder and removes those of an earlier run of the command;
    /// returns their names in order.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path that could not be replaced.
    pub fn commit(self) -> Result<Vec<String>, Failure> {
        let _lock = lock(&self.target);
        let names = names_in(&self.hidden).writable(&self.named)?;
        let record = self.check(&names)?;
        let commands = self.replaced();
        let own = record.files_of(&commands);
        let stale: Vec<String> = own.filter(|name| !names.contains(name)).cloned().collect();
        record.replace(&self.target, &self.hidden, &names, &stale, self.command)?;
        Ok(names)
    }
}

/// A line with the folder and the files that were written into it.
pub fn listed(folder: &Path, names: &[String]) -> String {
    const MAX_NAMES: usize = 12;
    let more = match names.len().saturating_sub(MAX_NAMES) {
        0 => String::new(),
        more => format!(" and {more} more files"),
    };
    let names = names[..names.len().min(MAX_NAMES)].join(", ");
    format!("{}: {names}{more}\n", folder.display())
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
            output.bytes(name, name)?;
        }
        output.commit().map(|_| ())
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
            output.bytes("x", "x")?;
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
        output.bytes("half", "half")?;
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
        assert!(refusal(&out, &["x"]).contains("was changed since"));
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
    fn a_folder_whose_files_are_half_moved_has_no_document() -> Outcome {
        let root = tempfile::tempdir()?;
        let out = root.path().join("out");
        let names = ["a.exr", "result.json", "z.png"];
        write_all(&out, false, &names)?;
        // A file that is missing ends the move as a kill would.
        let hidden = tempfile::tempdir()?;
        for name in &names[..2] {
            std::fs::write(hidden.path().join(name), "new")?;
        }
        let record = FolderRecord::read(&out).ok_or("a record")?;
        let moved = record.replace(&out, hidden.path(), &names.map(String::from), &[], "press");
        assert!(moved.is_err());
        assert_eq!(std::fs::read(out.join("a.exr"))?, b"new");
        assert!(!out.join("result.json").exists());
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
