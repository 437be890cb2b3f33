//! Recorded runs are not replaced by simulated ones.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;

use crate::output::staging::Staging;

/// The output folder, if the runs that it holds are simulated ones: recorded runs are not replaced.
///
/// # Errors
/// [`Failure::BadInput`] where they are not, and as [`Staging::beside`].
pub fn begin(
    inputs: &[PathBuf],
    folder: &Path,
    names: &[impl AsRef<Path>],
) -> Result<Staging, Failure> {
    let index = folder.join("runs.csv");
    let simulated = ["simulation.json", "truth.json"].map(|name| folder.join(name).is_file());
    if index.exists() && !simulated.contains(&true) {
        return Err(Failure::BadInput(format!(
            "{}: cannot be written: it stands there already and kufe simulate did not write it; expected another folder",
            index.display()
        )));
    }
    Staging::beside(inputs, folder, names)
}
