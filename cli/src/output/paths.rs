//! Where a command may write: never over what it reads, never through a link.

use std::path::{Component, Path, PathBuf};

use kufe::jobs::{Failure, case_file::LoadedCase};

/// Beginning of the names of temporary files and folders.
pub const TEMPORARY: &str = ".kufe-";

/// The path without `.`, `..` and links, as far as the file system has it.
///
/// Each existing part is resolved before `..` removes it, so `link/..` is the folder that the link
/// leads to. Parts that do not exist are taken as they are written: `new/../FILE` is `FILE`.
pub fn resolved(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let mut clean = PathBuf::new();
    for part in whole.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                clean.pop();
            }
            part => {
                clean.push(part);
                if let Ok(found) = clean.canonicalize() {
                    clean = found;
                }
            }
        }
    }
    clean
}

/// Whether two paths lead to one file; neither needs to exist.
pub fn same_file(a: &Path, b: &Path) -> bool {
    resolved(a) == resolved(b)
}

/// Whether a file is a link that leads out of its folder.
pub fn leads_out(file: &Path) -> bool {
    let folder = file.parent().unwrap_or(Path::new(""));
    file.is_symlink() && !resolved(file).starts_with(resolved(folder))
}

/// Checks that nothing but a regular file is at `path`, and that no input is there.
///
/// # Errors
/// Why the output cannot be at `path`: an input, a folder, a link, a device, a pipe or a socket.
pub fn check_place(path: &Path, inputs: &[PathBuf]) -> Result<(), &'static str> {
    if inputs.iter().any(|input| same_file(input, path)) {
        return Err("this command reads it; expected another place");
    }
    match path.symlink_metadata() {
        Ok(found) if found.is_symlink() => Err("a link is in the way"),
        Ok(found) if found.is_dir() => Err("a folder is in the way"),
        Ok(found) if !found.is_file() => Err("a device, a pipe or a socket is in the way"),
        _ => Ok(()),
    }
}

/// The failure to write `path`.
pub fn unwritable(path: &Path, reason: &dyn std::fmt::Display) -> Failure {
    Failure::BadInput(format!("{}: cannot be written: {reason}", path.display()))
}

/// Folders made for an output; those that are empty when this is dropped are removed.
#[derive(Clone)]
pub struct NewFolders(Vec<PathBuf>);

impl NewFolders {
    /// Makes `folder` and what is missing above it.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the folder that cannot be made.
    pub fn make(folder: &Path) -> Result<NewFolders, Failure> {
        let mut made = NewFolders(Vec::new());
        let missing: Vec<&Path> = folder
            .ancestors()
            .take_while(|path| !path.as_os_str().is_empty() && !path.exists())
            .collect();
        for path in missing.into_iter().rev() {
            match std::fs::create_dir(path) {
                Ok(()) => made.0.push(path.to_path_buf()),
                // Another process was faster.
                Err(_) if path.is_dir() => {}
                Err(error) => return Err(unwritable(path, &error)),
            }
        }
        Ok(made)
    }
}

impl Drop for NewFolders {
    fn drop(&mut self) {
        for path in self.0.iter().rev() {
            let _ = std::fs::remove_dir(path);
        }
    }
}

/// The files that a command reads that solves a case: the case, and all that it names.
///
/// # Errors
/// As [`LoadedCase::files`].
pub fn case_inputs(case: Option<&Path>, loaded: &LoadedCase) -> Result<Vec<PathBuf>, Failure> {
    let files = loaded.files()?;
    let mut inputs: Vec<PathBuf> = files.into_iter().map(|(_, path)| path).collect();
    inputs.extend(case.map(Path::to_path_buf));
    Ok(inputs)
}
