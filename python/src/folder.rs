//! New output folders: all files of a job are written or none.

use std::path::Path;

use kufe::jobs::field::NewFiles;
use kufe::jobs::{Failure, Located, Watch};

/// Calls `write` with a hidden folder next to `folder`, and moves it to `folder`, which must be new
/// or empty. After an interrupt `folder` is unchanged.
///
/// # Errors
/// Those of `write`, and [`Failure::BadInput`] if the folder is not empty or cannot be written.
pub fn write_folder<T>(
    folder: &Path,
    watch: &Watch,
    write: impl FnOnce(&NewFiles) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let whole = std::path::absolute(folder).writable(folder)?;
    // A folder that is not empty is refused here, and by the final rename.
    let mut entries = std::fs::read_dir(&whole).into_iter().flatten();
    if entries.next().is_some() {
        return Err("it is not empty; expected a new or an empty folder").writable(folder);
    }
    let above = whole.parent().unwrap_or(&whole);
    std::fs::create_dir_all(above).writable(folder)?;
    let hidden = tempfile::Builder::new().prefix(".kufe-").tempdir_in(above);
    let hidden = hidden.writable(folder)?;
    let written = write(&NewFiles {
        hidden: hidden.path().to_path_buf(),
        named: folder.to_path_buf(),
    })?;
    if watch.stopped() {
        return Err(Failure::Partial(format!("{}: stopped", folder.display())));
    }
    std::fs::create_dir_all(&whole).writable(folder)?;
    let complete = hidden.keep();
    let moved = std::fs::rename(&complete, &whole);
    if moved.is_err() {
        let _ = std::fs::remove_dir_all(&complete);
    }
    moved.writable(folder).map(|()| written)
}
