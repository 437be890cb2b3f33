//! Single output files, which are all written or none.

use std::fmt::Display;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use kufe::jobs::Failure;
use tempfile::{NamedTempFile, TempPath};

use crate::output::folder::FolderRecord;
use crate::output::marks::is_marked;
use crate::output::paths::{NewFolders, TEMPORARY, check_place, resolved, unwritable};

/// Endings of files that cannot state that kufe wrote them: they are compared once they are written.
const UNMARKED: [&str; 6] = ["csv", "fmu", "json", "md", "parquet", "toml"];

/// Files that a command writes at places of their own.
///
/// Each is new, or an earlier output of kufe, or replaced with `--force`. An input of the command
/// is never replaced. The files are moved to their places by [`OutputFiles::commit`].
pub struct OutputFiles {
    command: &'static str,
    inputs: Vec<PathBuf>,
    force: bool,
    outputs: Vec<Output>,
    written: Mutex<Vec<(usize, TempPath)>>,
    /// Removed on drop where they are still empty.
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
    /// # Errors
    /// [`Failure::BadInput`] for an output that is an input, is named twice, cannot be written, or
    /// exists and is not kufe's.
    pub fn begin(
        command: &'static str,
        inputs: &[PathBuf],
        outputs: &[PathBuf],
        force: bool,
    ) -> Result<OutputFiles, Failure> {
        let mut files = OutputFiles {
            command,
            inputs: inputs.to_vec(),
            force,
            outputs: Vec::new(),
            written: Mutex::default(),
            _made: Vec::new(),
        };
        for named in outputs {
            let output = Output {
                named: named.clone(),
                place: resolved(named),
            };
            if files.outputs.iter().any(|one| one.place == output.place) {
                return Err(unwritable(
                    named,
                    &"another output of this command goes there; expected another place",
                ));
            }
            let ending = named.extension().unwrap_or_default();
            if UNMARKED.iter().any(|unmarked| ending == *unmarked) {
                files.check_place(&output)?;
            } else {
                files.check(&output, None)?;
            }
            files.outputs.push(output);
        }
        for output in &files.outputs {
            let folder = folder_of(&output.place);
            files._made.push(NewFolders::make(folder)?);
            temporary_for(&output.place).map_err(|error| unwritable(&output.named, &error))?;
        }
        Ok(files)
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
        let failure = |error: &dyn Display| unwritable(path, error);
        self.draw(path, |to| {
            let file = File::create(to).map_err(|error| failure(&error))?;
            let mut writer = std::io::BufWriter::new(&file);
            write(&mut writer).map_err(|error| failure(&error))?;
            writer.flush().map_err(|error| failure(&error))?;
            drop(writer);
            file.sync_all().map_err(|error| failure(&error))
        })
    }

    /// Writes one of the outputs with a function that takes the path to write to.
    ///
    /// # Errors
    /// Those of the function; [`Failure::BadInput`] where there is no place for a temporary file.
    pub fn draw<E: Into<Failure>>(
        &self,
        path: &Path,
        draw: impl FnOnce(&Path) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let is_it = |output: &Output| output.named == path;
        let k = self.outputs.iter().position(is_it);
        let k = k.expect("an output that was stated at the beginning");
        let temporary = temporary_for(&self.outputs[k].place)
            .map_err(|error| unwritable(path, &error))?
            .into_temp_path();
        draw(&temporary).map_err(Into::into)?;
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        written.push((k, temporary));
        Ok(())
    }

    /// Moves the files to their places, in the order in which they were written.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with a path that is not as it was at the beginning.
    pub fn commit(self) -> Result<(), Failure> {
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        let written = std::mem::take(&mut *written);
        for (k, temporary) in &written {
            self.check(&self.outputs[*k], Some(temporary))?;
        }
        for (k, temporary) in written {
            let Output { named, place } = &self.outputs[k];
            let moved = if place.exists() {
                temporary.persist(place)
            } else {
                temporary.persist_noclobber(place)
            };
            moved.map_err(|error| unwritable(named, &error.error))?;
            let name = place.file_name().unwrap_or_default().to_string_lossy();
            FolderRecord::add(folder_of(place), &name, self.command);
        }
        Ok(())
    }

    /// Checks that an output is no input and leads where it led at the beginning.
    fn check_place(&self, output: &Output) -> Result<(), Failure> {
        check_place(&output.place, &self.inputs)
            .map_err(|reason| unwritable(&output.named, &reason))?;
        if resolved(&output.named) != output.place {
            return Err(unwritable(&output.named, &"it has become a link"));
        }
        Ok(())
    }

    /// Checks that an output may be replaced, by `content` if it is written already.
    fn check(&self, output: &Output, content: Option<&Path>) -> Result<(), Failure> {
        self.check_place(output)?;
        if self.force || !output.place.exists() {
            return Ok(());
        }
        let folder = folder_of(&output.place);
        let name = output.place.file_name().unwrap_or_default();
        let record = FolderRecord::read(folder);
        let writer = record
            .as_ref()
            .and_then(|record| record.writer_of(folder, &name.to_string_lossy()));
        let own = match writer {
            Some(writer) => writer == self.command,
            None => {
                is_marked(&output.place)
                    && content.is_none_or(|content| begin_alike(content, &output.place))
            }
        };
        if own || content.is_some_and(|content| are_equal(content, &output.place)) {
            return Ok(());
        }
        let reason = match writer {
            Some(writer) => format!("kufe {writer} wrote it; --force replaces it"),
            None => "it exists already; --force replaces it".to_owned(),
        };
        Err(unwritable(&output.named, &reason))
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("/"))
}

/// A temporary file in the folder of `place`, with its ending and the permissions of a new file.
fn temporary_for(place: &Path) -> std::io::Result<NamedTempFile> {
    let ending = place.extension().unwrap_or_default().to_string_lossy();
    let suffix = format!(".{ending}");
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY).suffix(&suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system removes the bits of the process's umask.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder_of(place))
}

/// Whether two files begin with the same bytes, as files of one format do.
fn begin_alike(a: &Path, b: &Path) -> bool {
    let head = |path: &Path| {
        let mut head = Vec::new();
        File::open(path)?.take(4).read_to_end(&mut head)?;
        Ok::<_, std::io::Error>(head)
    };
    matches!((head(a), head(b)), (Ok(a), Ok(b)) if a == b)
}

fn are_equal(a: &Path, b: &Path) -> bool {
    let length = |path: &Path| path.metadata().map(|found| found.len()).ok();
    let content = |path: &Path| std::fs::read(path).ok();
    length(a) == length(b) && content(a).is_some_and(|bytes| Some(bytes) == content(b))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_file_that_exists_is_replaced_by_its_own_kind_or_with_force() -> Outcome {
        let root = tempfile::tempdir()?;
        let write = |name: &str, text: &str, force| write(root.path(), name, text, force);
        std::fs::write(root.path().join("in"), "read")?;
        write("a.csv", "1", false)?;
        write("a.csv", "1", false)?;
        assert!(write("a.csv", "2", false).unwrap_err().contains("--force"));
        assert!(write("new/../a.csv", "2", false).is_err());
        assert!(!root.path().join("new").exists());
        write("a.csv", "2", true)?;
        write("new/a.csv", "3", false)?;
        write("a.html", "<html> kufe 0.1.0", false)?;
        write("a.html", "<html> kufe 0.1.0, again", false)?;
        assert!(write("a.html", "# kufe 0.1.0", false).is_err());
        for name in ["in", "./in", "none/../in"] {
            assert!(
                write(name, "x", true).unwrap_err().contains("reads it"),
                "{name}"
            );
        }
        let entries = std::fs::read_dir(root.path())?;
        let hidden = |name: &std::ffi::OsString| name.to_string_lossy().starts_with('.');
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
