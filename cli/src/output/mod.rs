//! Outputs that are written completely or not at all, and replace only earlier outputs of kufe.

mod file;
mod folder;
mod record;

use std::fs::DirEntry;
use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe_files::{TEMPORARY, TemporaryFolder, clear_temporaries};

pub use file::{OutputFiles, write_file};
pub use folder::{OutputDir, listed};
pub use record::{FolderRecord, remove_outputs};

/// Largest number of attempts to create a folder that other processes remove.
const MAX_ATTEMPTS: usize = 20;

/// Sorted names of the entries of a folder.
fn names_in(folder: &Path) -> std::io::Result<Vec<String>> {
    let entries = std::fs::read_dir(folder)?;
    let name =
        |entry: std::io::Result<DirEntry>| Ok(entry?.file_name().to_string_lossy().into_owned());
    let mut names = entries
        .map(name)
        .collect::<std::io::Result<Vec<String>>>()?;
    names.sort();
    Ok(names)
}

/// The input files of a command that solves a case: the case, and all files that it names.
///
/// # Errors
/// As [`LoadedCase::files`].
pub fn case_inputs(case: Option<&Path>, loaded: &LoadedCase) -> Result<Vec<PathBuf>, Failure> {
    let files = loaded.files()?;
    let mut inputs: Vec<PathBuf> = files.into_iter().map(|(_, path)| path).collect();
    inputs.extend(case.map(Path::to_path_buf));
    Ok(inputs)
}

/// A hidden folder for new files within their final folder. On drop it is removed, and so is the
/// final folder if it was created for it and is empty.
struct Staging {
    /// Dropped before the folders that contain it.
    hidden: TemporaryFolder,
    made: NewFolders,
}

impl Staging {
    /// A hidden folder in `folder`, which is created if it is missing.
    fn in_folder(folder: &Path) -> std::io::Result<Staging> {
        let attempt = |_| {
            let missing = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
            let missing = folder.ancestors().take_while(missing);
            let made = NewFolders(missing.map(Path::to_path_buf).collect());
            std::fs::create_dir_all(folder)?;
            let hidden = TemporaryFolder::new_in(folder)?;
            clear_temporaries(folder);
            Ok(Staging { hidden, made })
        };
        // Other processes that give up may remove the folder meanwhile.
        let mut failed = (1..MAX_ATTEMPTS).map(attempt).skip_while(Result::is_err);
        failed.next().unwrap_or_else(|| attempt(0))
    }
}

/// Folders that were created, the innermost first.
#[derive(Clone)]
struct NewFolders(Vec<PathBuf>);

impl Drop for NewFolders {
    fn drop(&mut self) {
        for path in &self.0 {
            let _ = std::fs::remove_dir(path);
        }
    }
}

/// Installs a handler for interrupts that removes hidden folders and the folders created for them,
/// and ends the process with code 130.
fn remove_on_interrupt<'a>(staged: impl IntoIterator<Item = &'a Staging>) {
    let staged = staged.into_iter();
    let staged = staged.map(|one| (one.hidden.path().to_path_buf(), one.made.clone()));
    let (hidden, made): (Vec<PathBuf>, Vec<NewFolders>) = staged.unzip();
    // A process that handles interrupts already continues to do so.
    let _ = ctrlc::set_handler(move || {
        for folder in &hidden {
            let _ = std::fs::remove_dir_all(folder);
        }
        drop(made.clone());
        std::process::exit(130);
    });
}
