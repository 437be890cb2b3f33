//! Files that are whole or absent.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::Failure;

/// Writes `path` through a temporary file in its folder that is renamed once it is whole.
///
/// # Errors
/// [`Failure::BadInput`] with the path where the folder or the file cannot be written.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let told = |error: std::io::Error| {
        Failure::BadInput(format!("{}: cannot be written: {error}", path.display()))
    };
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(told)?;
    let mut temporary = tempfile::Builder::new()
        .prefix(".kufe-")
        .tempfile_in(folder)
        .map_err(told)?;
    {
        let mut writer = BufWriter::new(temporary.as_file_mut());
        write(&mut writer)
            .and_then(|()| writer.flush())
            .map_err(told)?;
    }
    set_ordinary_permissions(temporary.as_file()).map_err(told)?;
    temporary.persist(path).map_err(|error| told(error.error))?;
    Ok(())
}

/// Temporary files are private; a result is readable like any other new file.
#[cfg(unix)]
fn set_ordinary_permissions(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_ordinary_permissions(_file: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
