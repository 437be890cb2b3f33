//! Single output files, which are all written or none.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_files::{outputs_apart, resolved};
use tempfile::TempDir;

use crate::output::folder::{hash, lock};
use crate::output::{FolderRecord, NewFolders, Staging, remove_on_interrupt, unwritable};

/// Files that a command writes at places of their own.
///
/// Each is new, or what the same command wrote there and nobody changed, or replaced with
/// `--force`. An input of the command is never replaced. The files are moved to their places by
/// [`OutputFiles::commit`], which adds them to the records of their folders.
pub struct OutputFiles {
    command: &'static str,
    inputs: Vec<PathBuf>,
    force: bool,
    outputs: Vec<Output>,
    /// A hidden folder in each folder that receives files.
    hidden: BTreeMap<PathBuf, TempDir>,
    /// Dropped after the hidden folders in them.
    _made: Vec<NewFolders>,
}

struct Output {
    /// As the user names it.
    named: PathBuf,
    /// Its place, without links.
    place: PathBuf,
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
        outputs_apart(inputs, outputs).map_err(Failure::bad_input)?;
        let outputs = outputs.iter().map(|named| Output {
            named: named.clone(),
            place: resolved(named),
        });
        let mut files = OutputFiles {
            command,
            inputs: inputs.to_vec(),
            force,
            outputs: outputs.collect(),
            hidden: BTreeMap::new(),
            _made: Vec::new(),
        };
        for output in &files.outputs {
            files.check(output)?;
        }
        for Output { named, place } in &files.outputs {
            let folder = folder_of(place);
            if !files.hidden.contains_key(folder) {
                let staging = Staging::in_folder(folder);
                let Staging { hidden, made } =
                    staging.map_err(|error| unwritable(named, &error))?;
                files.hidden.insert(folder.to_path_buf(), hidden);
                files._made.insert(0, made);
            }
        }
        remove_on_interrupt(files.hidden.values(), &files._made);
        Ok(files)
    }

    /// Where an output is written before it is moved.
    fn new_file(&self, output: &Output) -> PathBuf {
        let hidden = &self.hidden[folder_of(&output.place)];
        hidden.path().join(name_of(&output.place))
    }

    /// Writes one of the outputs with a function that takes a writer.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with its path where it cannot be written.
    pub fn write<E: Display>(
        &self,
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let output = self.outputs.iter().find(|output| output.named == path);
        let output = output.expect("an output that was stated at the beginning");
        let failure = |error: &dyn Display| unwritable(path, error);
        let file = File::create(self.new_file(output)).map_err(|error| failure(&error))?;
        let mut writer = std::io::BufWriter::new(&file);
        write(&mut writer).map_err(|error| failure(&error))?;
        writer.flush().map_err(|error| failure(&error))?;
        drop(writer);
        file.sync_all().map_err(|error| failure(&error))
    }

    /// Moves the files that were written to their places.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with a path that is not as it was at the beginning.
    pub fn commit(self) -> Result<(), Failure> {
        let outputs = self.outputs.iter();
        let written = outputs.map(|output| (output, self.new_file(output)));
        let written: Vec<(&Output, PathBuf)> = written.filter(|(_, new)| new.exists()).collect();
        let _locks: Vec<_> = self.hidden.keys().map(|folder| lock(folder)).collect();
        let named: Vec<&PathBuf> = written.iter().map(|(output, _)| &output.named).collect();
        outputs_apart(&self.inputs, &named).map_err(Failure::bad_input)?;
        for (output, _) in &written {
            let Output { named, place } = output;
            if resolved(named) != *place {
                return Err(unwritable(named, &"it has become a link"));
            }
            self.check(output)?;
        }
        for folder in self.hidden.keys() {
            let of_folder = written.iter();
            let of_folder = of_folder.filter(|(output, _)| folder_of(&output.place) == folder);
            let hashes = of_folder.filter_map(|(o, new)| Some((name_of(&o.place), hash(new)?)));
            FolderRecord::add(folder, hashes, self.command);
        }
        for (output, new) in &written {
            std::fs::rename(new, &output.place)
                .map_err(|error| unwritable(&output.named, &error))?;
        }
        Ok(())
    }

    /// Checks that what is at the place of an output may be replaced.
    fn check(&self, Output { named, place }: &Output) -> Result<(), Failure> {
        if self.force || !place.exists() {
            return Ok(());
        }
        let reason = match FolderRecord::writer_of(folder_of(place), &name_of(place)) {
            Some(writer) if writer == self.command => return Ok(()),
            Some(writer) => format!("kufe {writer} wrote it; --force replaces it"),
            None => {
                "it exists already, and kufe did not write it so; --force replaces it".to_owned()
            }
        };
        Err(unwritable(named, &reason))
    }
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

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    /// Writes a file of a folder; `in` is read.
    fn write(folder: &Path, name: &str, text: &str, force: bool) -> Result<(), String> {
        let path = folder.join(name);
        let outputs = std::slice::from_ref(&path);
        let write = || {
            let files = OutputFiles::begin("lut", &[folder.join("in")], outputs, force)?;
            files.write(&path, |writer| writer.write_all(text.as_bytes()))?;
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
