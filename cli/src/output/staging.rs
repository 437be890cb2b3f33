//! Output folders that receive all of their files or none.

use std::path::{Path, PathBuf};

use kufe_jobs::Failure;
use tempfile::TempDir;

/// A hidden folder beside the output that collects files until [`Staging::commit`] moves them in.
///
/// Made before the work starts, so that an output that cannot be written fails at once. Dropped
/// without a commit it takes its files, and the folders it had to make, with it.
pub struct Staging {
    target: PathBuf,
    made: Vec<PathBuf>,
    folder: Option<TempDir>,
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
        };
        let missing: Vec<&Path> = target
            .ancestors()
            .filter(|path| !path.as_os_str().is_empty())
            .take_while(|path| !path.exists())
            .collect();
        for path in missing.into_iter().rev() {
            std::fs::create_dir(path).map_err(|error| unwritable(path, &error))?;
            staging.made.push(path.to_path_buf());
        }
        let folder = tempfile::Builder::new()
            .prefix(".kufe-")
            .tempdir_in(target)
            .map_err(|error| unwritable(target, &error))?;
        staging.folder = Some(folder);
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

    /// Moves every file into the output folder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path that could not be replaced.
    pub fn commit(mut self) -> Result<(), Failure> {
        let Some(folder) = self.folder.take() else {
            return Ok(());
        };
        let told = |error: std::io::Error| unwritable(&self.target, &error);
        let mut names = Vec::new();
        for entry in std::fs::read_dir(folder.path()).map_err(told)? {
            names.push(entry.map_err(told)?.file_name());
        }
        names.sort();
        for name in &names {
            if self.target.join(name).is_dir() {
                return Err(unwritable(
                    &self.target.join(name),
                    &"a folder of that name is in the way",
                ));
            }
        }
        for name in &names {
            let to = self.target.join(name);
            std::fs::rename(folder.path().join(name), &to)
                .map_err(|error| unwritable(&to, &error))?;
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
