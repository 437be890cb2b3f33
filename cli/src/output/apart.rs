//! What a command writes is not what it reads, checked before it works.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe_files::outputs_apart;

/// Refuses outputs that are inputs or one another, and what is no file where a file is to be.
///
/// # Errors
/// [`Failure::BadInput`] with the output.
pub fn apart(inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<(), Failure> {
    outputs_apart(inputs, outputs).map_err(Failure::bad_input)
}

/// As [`apart`], for the files of these names in an output folder.
///
/// # Errors
/// As [`apart`].
pub fn folder_apart(
    inputs: &[PathBuf],
    folder: &Path,
    names: &[impl AsRef<Path>],
) -> Result<(), Failure> {
    let outputs: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    apart(inputs, &outputs)
}

/// What a command reads that solves a case: the case, if it is a file, and all that it names.
///
/// # Errors
/// As [`LoadedCase::files`].
pub fn case_inputs(case: Option<&Path>, loaded: &LoadedCase) -> Result<Vec<PathBuf>, Failure> {
    let files = loaded.files()?;
    let mut inputs: Vec<PathBuf> = files.into_iter().map(|(_, path)| path).collect();
    inputs.extend(case.map(Path::to_path_buf));
    Ok(inputs)
}
