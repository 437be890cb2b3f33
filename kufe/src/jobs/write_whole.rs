//! Results as files.

use std::io::Write;
use std::path::Path;

use crate::jobs::failure::Failure;

/// Writes `path`, whole or not at all; makes its folder where that is missing.
///
/// # Errors
/// [`Failure::BadInput`] with the path where the folder or the file cannot be written.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let made = if folder.as_os_str().is_empty() {
        Ok(())
    } else {
        std::fs::create_dir_all(folder)
    };
    made.and_then(|()| kufe_files::write_whole(path, write))
        .map_err(|error| {
            Failure::BadInput(format!("{}: cannot be written: {error}", path.display()))
        })
}
