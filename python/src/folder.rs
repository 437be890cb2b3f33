//! New folders, which receive all files of a job or none.

use std::path::Path;

use kufe::jobs::field::NewFiles;
use kufe::jobs::{Failure, Watch};

/// Lets `write` write files into a hidden folder next to `folder` and moves it there. `folder` must
/// be new or empty; an interrupt leaves it as it is.
///
/// # Errors
/// Those of `write`, and [`Failure::BadInput`] where the folder is not empty or cannot be written.
pub fn write_folder<T>(
    folder: &Path,
    watch: &Watch,
    write: impl FnOnce(NewFiles) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let failed = |reason: &dyn std::fmt::Display| Failure::unwritable(folder, reason);
    let whole = std::path::absolute(folder).map_err(|error| failed(&error))?;
    // A folder that is not empty is refused before the work, and by the system after it.
    let mut there = std::fs::read_dir(&whole).into_iter().flatten();
    if there.next().is_some() {
        return Err(failed(
            &"it is not empty; expected a new or an empty folder",
        ));
    }
    let above = whole.parent().unwrap_or(&whole);
    std::fs::create_dir_all(above).map_err(|error| failed(&error))?;
    let hidden = tempfile::Builder::new().prefix(".kufe-").tempdir_in(above);
    let hidden = hidden.map_err(|error| failed(&error))?;
    let written = write(NewFiles {
        hidden: hidden.path(),
        named: folder,
    })?;
    if watch.stopped() {
        return Err(Failure::Partial(format!("{}: stopped", folder.display())));
    }
    std::fs::create_dir_all(&whole).map_err(|error| failed(&error))?;
    let kept = hidden.keep();
    std::fs::rename(&kept, &whole).map_err(|error| {
        let _ = std::fs::remove_dir_all(&kept);
        failed(&error)
    })?;
    Ok(written)
}
