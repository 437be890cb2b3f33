//! Output folders that receive all of their files or none.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_files::clear_temporaries;
use serde::Serialize;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::output::apart::{apart, folder_apart};
use crate::output::held::{FILES, Held};

/// The file that names others of its folder.
const INDEX: &str = "runs.csv";

/// A hidden folder beside the output that collects files until [`Staging::commit`] moves them in.
///
/// Made before the work starts, so that an output that cannot be written fails at once. Dropped
/// without a commit it takes its files, and the folders it had to make, with it.
pub struct Staging {
    target: PathBuf,
    made: Vec<PathBuf>,
    folder: Option<TempDir>,
    inputs: Vec<PathBuf>,
    held: Option<Held>,
}

impl Staging {
    /// Makes the output folder where it does not exist, and the hidden one in it.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path where that is not possible.
    pub fn begin(target: &Path) -> Result<Staging, Failure> {
        let mut staging = Staging {
            target: target.to_path_buf(),
            made: Vec::new(),
            folder: None,
            inputs: Vec::new(),
            held: None,
        };
        let missing: Vec<&Path> = target
            .ancestors()
            .filter(|path| !path.as_os_str().is_empty())
            .take_while(|path| !path.exists())
            .collect();
        for path in missing.into_iter().rev() {
            match std::fs::create_dir(path) {
                Ok(()) => staging.made.push(path.to_path_buf()),
                // Another command that writes beside this one was first.
                Err(_) if path.is_dir() => {}
                Err(error) => return Err(unwritable(path, &error)),
            }
        }
        clear_temporaries(target);
        let folder = tempfile::Builder::new()
            .prefix(".kufe-")
            .tempdir_in(target)
            .map_err(|error| unwritable(target, &error))?;
        staging.folder = Some(folder);
        Ok(staging)
    }

    /// As [`Staging::begin`], for a command that reads these inputs: none of its files may take the place of one, nor of
    /// what kufe did not write, and those that an earlier run of it wrote and this one does not go.
    ///
    /// What will surely be written is checked now, the rest when it is moved in.
    ///
    /// # Errors
    /// As [`Staging::begin`]; [`Failure::BadInput`] for a name that is an input's, or no file's; as [`Held::check`].
    pub fn beside(
        inputs: &[PathBuf],
        target: &Path,
        names: &[impl AsRef<Path>],
    ) -> Result<Staging, Failure> {
        folder_apart(inputs, target, names)?;
        let held = Held::of(target);
        held.check(inputs, names)?;
        let mut staging = Staging::begin(target)?;
        staging.inputs = inputs.to_vec();
        staging.held = Some(held);
        Ok(staging)
    }

    /// Where to write the file `name` for now.
    pub fn path(&self, name: &str) -> PathBuf {
        match &self.folder {
            Some(folder) => folder.path().join(name),
            None => self.target.join(name),
        }
    }

    /// Removes the hidden folder when the user interrupts, then leaves with code 130.
    ///
    /// Has no effect in a process that handles interrupts already.
    pub fn remove_on_interrupt(&self) {
        let Some(folder) = &self.folder else { return };
        let hidden = folder.path().to_path_buf();
        let made = self.made.clone();
        let _ = ctrlc::set_handler(move || {
            let _ = std::fs::remove_dir_all(&hidden);
            for path in made.iter().rev() {
                let _ = std::fs::remove_dir(path);
            }
            std::process::exit(130);
        });
    }

    /// The failure to write the file `name`.
    pub fn failure(&self, name: &str, reason: &dyn std::fmt::Display) -> Failure {
        unwritable(&self.target.join(name), reason)
    }

    /// Writes one file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path of the file to be where it cannot be written.
    pub fn write<E: std::fmt::Display>(
        &self,
        name: &str,
        write: impl FnOnce(&std::fs::File) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let told = |reason: &dyn std::fmt::Display| self.failure(name, reason);
        let file = std::fs::File::create(self.path(name)).map_err(|error| told(&error))?;
        write(&file).map_err(|error| told(&error))?;
        file.sync_all().map_err(|error| told(&error))
    }

    /// Writes one file of text, in one piece.
    ///
    /// # Errors
    /// As [`write`](Staging::write).
    pub fn text(&self, name: &str, text: &str) -> Result<(), Failure> {
        self.write(name, |mut file| {
            std::io::Write::write_all(&mut file, text.as_bytes())
        })
    }

    /// Writes the document that says what the folder holds, after the other files: it lists them with their lengths.
    ///
    /// # Errors
    /// As [`write`](Staging::write).
    pub fn document(&self, name: &str, document: &mut Value) -> Result<(), Failure> {
        let lengths = self.lengths().map_err(|error| self.failure(name, &error))?;
        document[FILES] = json!(lengths);
        self.text(name, &format!("{document:#}\n"))
    }

    /// As [`document`](Staging::document), of a typed result; returns the text that was written.
    ///
    /// # Errors
    /// As [`write`](Staging::write).
    pub fn result(&self, name: &str, result: &impl Serialize) -> Result<String, Failure> {
        #[derive(Serialize)]
        struct WithFiles<'a, T> {
            #[serde(flatten)]
            result: &'a T,
            files: BTreeMap<String, u64>,
        }
        let files = self.lengths().map_err(|error| self.failure(name, &error))?;
        let text = pretty(&WithFiles { result, files })?;
        self.text(name, &text)?;
        Ok(text)
    }

    /// The files that are written so far, with their lengths [bytes].
    fn lengths(&self) -> std::io::Result<BTreeMap<String, u64>> {
        let length = |file: PathBuf| {
            let name = file.to_string_lossy().into_owned();
            let length = std::fs::metadata(self.path(&name))?.len();
            Ok((name, length))
        };
        self.names()?.into_iter().map(length).collect()
    }

    /// Names of what is written so far, sorted; an index of runs last.
    fn names(&self) -> std::io::Result<Vec<PathBuf>> {
        let mut names: Vec<PathBuf> = Vec::new();
        for entry in std::fs::read_dir(self.path(""))? {
            names.push(entry?.file_name().into());
        }
        names.sort_by_key(|name| (name == Path::new(INDEX), name.clone()));
        Ok(names)
    }

    /// Moves every file into the output folder; an index of runs goes first and comes last, so that what it names is whole
    /// also where this is killed.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path that could not be replaced.
    pub fn commit(mut self) -> Result<(), Failure> {
        let told = |error: std::io::Error| unwritable(&self.target, &error);
        let names = self.names().map_err(told)?;
        let Some(folder) = self.folder.take() else {
            return Ok(());
        };
        let outputs: Vec<PathBuf> = names.iter().map(|name| self.target.join(name)).collect();
        apart(&self.inputs, &outputs)?;
        let mut replaced = Vec::new();
        if let Some(held) = self.held.take() {
            held.check(&self.inputs, &names)?;
            replaced = held.replaced(&self.inputs, &names);
        }
        let old = self.target.join(INDEX);
        if names.iter().any(|name| name == Path::new(INDEX)) && old.is_file() && !old.is_symlink() {
            std::fs::remove_file(&old).map_err(|error| unwritable(&old, &error))?;
        }
        for file in replaced.iter().filter(|file| !outputs.contains(file)) {
            std::fs::remove_file(file).map_err(|error| unwritable(file, &error))?;
        }
        for (name, to) in names.iter().zip(&outputs) {
            place(&folder.path().join(name), to).map_err(|error| unwritable(to, &error))?;
        }
        self.made.clear();
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // The hidden folder goes first; folders that someone else has filled meanwhile stay.
        self.folder.take();
        for path in self.made.iter().rev() {
            let _ = std::fs::remove_dir(path);
        }
    }
}

/// A document as JSON that people can read.
///
/// # Errors
/// [`Failure::BadInput`] where JSON cannot hold it.
pub fn pretty(document: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(document).map_err(Failure::bad_input)?;
    Ok(text + "\n")
}

/// Moves a file to its place; where that is a link, what it leads to is written.
fn place(from: &Path, to: &Path) -> std::io::Result<()> {
    if to.is_symlink() {
        let mut file = std::fs::File::open(from)?;
        return kufe_files::write_whole(to, |writer| std::io::copy(&mut file, writer).map(|_| ()));
    }
    std::fs::rename(from, to)
}

fn unwritable(path: &Path, reason: &dyn std::fmt::Display) -> Failure {
    Failure::BadInput(format!("{}: cannot be written: {reason}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_appear_together_and_a_failure_leaves_nothing() -> Result<(), Box<dyn std::error::Error>>
    {
        let root = tempfile::tempdir()?;
        let out = root.path().join("a/b");
        {
            let staging = Staging::begin(&out).map_err(|failure| failure.to_string())?;
            std::fs::write(staging.path("half.txt"), "half")?;
        }
        assert!(!root.path().join("a").exists());
        let staging = Staging::begin(&out).map_err(|failure| failure.to_string())?;
        std::fs::write(staging.path("whole.txt"), "whole")?;
        assert!(!out.join("whole.txt").exists());
        staging.commit().map_err(|failure| failure.to_string())?;
        let names: Vec<_> = std::fs::read_dir(&out)?
            .filter_map(Result::ok)
            .map(|e| e.file_name())
            .collect();
        assert_eq!(names, ["whole.txt"]);
        Ok(())
    }

    #[test]
    fn commands_that_begin_at_once_share_the_folders_above_their_own()
    -> Result<(), Box<dyn std::error::Error>> {
        for _ in 0..50 {
            let root = tempfile::tempdir()?;
            let start = std::sync::Barrier::new(4);
            let begin = |k: usize| {
                start.wait();
                let staging = Staging::begin(&root.path().join(format!("a/b/{k}")));
                staging.map_err(|failure| failure.to_string())
            };
            let begun: Vec<Result<Staging, String>> = std::thread::scope(|scope| {
                let each: Vec<_> = (0..4)
                    .map(|k| {
                        scope.spawn({
                            let begin = &begin;
                            move || begin(k)
                        })
                    })
                    .collect();
                each.into_iter()
                    .map(|one| one.join().expect("no panic"))
                    .collect()
            });
            for staging in begun {
                staging?;
            }
        }
        Ok(())
    }

    #[test]
    fn a_file_in_the_way_of_the_folder_is_named() -> Result<(), Box<dyn std::error::Error>> {
        let root = tempfile::tempdir()?;
        let file = root.path().join("file");
        std::fs::write(&file, "")?;
        let failure = Staging::begin(&file.join("out"))
            .map(|_| ())
            .expect_err("a file is no folder");
        assert!(
            failure.to_string().contains("cannot be written"),
            "{failure}"
        );
        Ok(())
    }
}
