//! New output folders: all files of a job are written or none.

use std::path::Path;

use kufe::jobs::field::NewFiles;
use kufe::jobs::{Failure, Watch};

/// Calls `write` with a hidden folder next to `folder`, and moves it to `folder`, which must be new
/// or empty. After an interrupt `folder` is unchanged.
///
/// # Errors
/// Those of `write`, and [`Failure::BadInput`] if the folder is not empty or cannot be written.
pub fn write_folder<T>(
    folder: &Path,
    watch: &Watch,
    write: impl FnOnce(NewFiles) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let failed = |reason: &dyn std::fmt::Display| Failure::unwritable(folder, reason);
    let whole = std::path::absolute(folder).map_err(|error| failed(&error))?;
    // A folder that is not empty is refused here, and by the final rename.
    let mut entries = std::fs::read_dir(&whole).into_iter().flatten();
    if entries.next().is_some() {
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
