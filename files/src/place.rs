//! Checks of the path of a file that is to be written.

use std::fs::FileType;
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// The file that writing to `path` replaces or creates: `path` itself, or the target of a link.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] if that is a folder, a device, a pipe or a socket, or if the target
/// of the link does not exist.
pub(crate) fn replaceable(path: &Path) -> Result<PathBuf> {
    let failure = |reason: &str| Error::new(ErrorKind::InvalidInput, reason.to_owned());
    let place = match path.symlink_metadata() {
        Ok(found) if found.is_symlink() => path
            .canonicalize()
            .map_err(|_| failure("a link that leads nowhere is in the way"))?,
        _ => path.to_path_buf(),
    };
    match place.symlink_metadata() {
        Ok(found) if !found.is_file() => Err(failure(&format!(
            "{} of that name is in the way",
            kind(found.file_type())
        ))),
        _ => Ok(place),
    }
}

/// Name of the kind of a file that is not regular.
pub(crate) fn kind(found: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if found.is_fifo() {
            return "a pipe";
        }
        if found.is_socket() {
            return "a socket";
        }
        if found.is_char_device() || found.is_block_device() {
            return "a device";
        }
    }
    if found.is_dir() {
        "a folder"
    } else {
        "something that is no file"
    }
}

/// The folder of a path's file.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}
