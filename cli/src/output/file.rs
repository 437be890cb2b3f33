//! Single output files, which are all written or none.

use std::fmt::Display;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_files::{open_regular, outputs_apart, resolved};
use tempfile::TempDir;

use crate::output::{FolderRecord, NewFolders, Staging, unwritable};

/// Endings of files that cannot state that kufe wrote them: they are compared once they are
/// written.
const UNMARKED: [&str; 6] = ["csv", "fmu", "json", "md", "parquet", "toml"];
/// Length of a file's beginning that contains the mark of kufe [bytes].
const HEAD: u64 = 1 << 13;
/// Marks of plans and tables, apart from `kufe 1.2.3`.
const FORMATS: [&str; 1] = ["\"kufe-lut"];
/// Bytes before the mark that two files of one kind have in common.
const BEFORE: usize = 8;

/// Files that a command writes at places of their own.
///
/// Each is new, or an earlier output of kufe, or replaced with `--force`. An input of the command
/// is never replaced. The files are moved to their places by [`OutputFiles::commit`].
pub struct OutputFiles {
    command: &'static str,
    inputs: Vec<PathBuf>,
    force: bool,
    outputs: Vec<Output>,
    /// Dropped after the hidden folders in them.
    _made: Vec<NewFolders>,
}

struct Output {
    /// As the user names it.
    named: PathBuf,
    /// Its place, without links.
    place: PathBuf,
    /// A folder in that of the place.
    hidden: TempDir,
}

impl Output {
    /// Where it is written before it is moved.
    fn new_file(&self) -> PathBuf {
        self.hidden.path().join(name_of(&self.place))
    }
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
        outputs_apart(inputs, outputs).map_err(Failure::bad_input)?;
        let mut files = OutputFiles {
            command,
            inputs: inputs.to_vec(),
            force,
            outputs: Vec::new(),
            _made: Vec::new(),
        };
        for named in outputs {
            let ending = named.extension().unwrap_or_default();
            if !UNMARKED.iter().any(|unmarked| ending == *unmarked) {
                files.check(named, &resolved(named), None)?;
            }
        }
        for named in outputs {
            let place = resolved(named);
            let staging = Staging::in_folder(folder_of(&place));
            let Staging { hidden, made } = staging.map_err(|error| unwritable(named, &error))?;
            files._made.insert(0, made);
            files.outputs.push(Output {
                named: named.clone(),
                place,
                hidden,
            });
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
        let output = self.outputs.iter().find(|output| output.named == path);
        let output = output.expect("an output that was stated at the beginning");
        let failure = |error: &dyn Display| unwritable(path, error);
        let file = File::create(output.new_file()).map_err(|error| failure(&error))?;
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
        let written = || {
            self.outputs
                .iter()
                .filter(|output| output.new_file().exists())
        };
        for output in written() {
            let Output { named, place, .. } = output;
            outputs_apart(&self.inputs, &[named]).map_err(Failure::bad_input)?;
            if resolved(named) != *place {
                return Err(unwritable(named, &"it has become a link"));
            }
            self.check(named, place, Some(&output.new_file()))?;
        }
        for output in written() {
            let place = &output.place;
            std::fs::rename(output.new_file(), place)
                .map_err(|error| unwritable(&output.named, &error))?;
            FolderRecord::add(folder_of(place), &name_of(place), self.command);
        }
        Ok(())
    }

    /// Checks that what is at `place` may be replaced, by `content` if it is written already.
    fn check(&self, named: &Path, place: &Path, content: Option<&Path>) -> Result<(), Failure> {
        if self.force || !place.exists() {
            return Ok(());
        }
        let writer = FolderRecord::writer_of(folder_of(place), &name_of(place));
        let own = match &writer {
            Some(writer) => writer == self.command,
            None => {
                mark(place).is_some_and(|found| content.is_none_or(|new| mark(new) == Some(found)))
            }
        };
        if own || content.is_some_and(|content| head(content, u64::MAX) == head(place, u64::MAX)) {
            return Ok(());
        }
        let reason = match writer {
            Some(writer) => format!("kufe {writer} wrote it; --force replaces it"),
            None => "it exists already; --force replaces it".to_owned(),
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

/// What a file states near its beginning to be kufe's, by name and version or a format: its first
/// bytes and those before the mark, which are equal in files of one kind.
fn mark(path: &Path) -> Option<(Vec<u8>, Vec<u8>)> {
    let head = head(path, HEAD)?;
    let is_version = |rest: &[u8]| {
        let end = rest.iter().position(|c| !c.is_ascii_digit() && *c != b'.');
        let version = String::from_utf8_lossy(&rest[..end.unwrap_or(rest.len())]);
        version.trim_end_matches('.').split('.').count() == 3
    };
    let is_mark = |at: &usize| {
        let rest = &head[*at..];
        rest.strip_prefix(b"kufe ").is_some_and(is_version)
            || FORMATS.iter().any(|mark| rest.starts_with(mark.as_bytes()))
    };
    let at = (0..head.len()).find(is_mark)?;
    let before = &head[at.saturating_sub(BEFORE)..at];
    Some((head[..4.min(at)].to_vec(), before.to_vec()))
}

/// The first bytes of a file, `None` where it cannot be read.
fn head(path: &Path, bytes: u64) -> Option<Vec<u8>> {
    let mut head = Vec::new();
    let file = open_regular(path).ok()?;
    file.take(bytes).read_to_end(&mut head).ok()?;
    Some(head)
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
        for other in ["# kufe 0.1.0", "<html> Lists, kufe 0.1.0", "<html>"] {
            assert!(write("a.html", other, false).is_err(), "{other}");
        }
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
