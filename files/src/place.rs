//! Where a file may be written.

use std::fs::FileType;
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// The file that writing to `path` replaces or makes: `path` itself, or what it leads to where it is a link.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] where that is a folder, a device, a pipe or a socket, or a link that leads nowhere.
pub fn replaceable(path: &Path) -> Result<PathBuf> {
    let told = |reason: &str| Error::new(ErrorKind::InvalidInput, reason.to_owned());
    let place = match path.symlink_metadata() {
        Ok(found) if found.is_symlink() => path
            .canonicalize()
            .map_err(|_| told("a link that leads nowhere is in the way"))?,
        _ => path.to_path_buf(),
    };
    match place.symlink_metadata() {
        Ok(found) if !found.is_file() => Err(told(&format!(
            "{} of that name is in the way",
            kind(found.file_type())
        ))),
        _ => Ok(place),
    }
}

/// What a thing that is no regular file is.
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

/// The folder that a path's file stands in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::write_whole;
    use std::os::unix::fs::{FileTypeExt, symlink};

    #[test]
    fn a_link_is_written_through_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, "before").unwrap();
        symlink("file", &link).unwrap();
        write_whole(&link, |writer| writer.write_all(b"after")).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"after");
        assert!(link.symlink_metadata().unwrap().is_symlink());
        let lost = folder.path().join("lost");
        symlink("nowhere", &lost).unwrap();
        let error = write_whole(&lost, |writer| writer.write_all(b"x")).unwrap_err();
        assert!(error.to_string().contains("leads nowhere"), "{error}");
        assert!(lost.symlink_metadata().unwrap().is_symlink());
    }

    #[test]
    fn folders_sockets_and_devices_are_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let inner = folder.path().join("folder");
        std::fs::create_dir(&inner).unwrap();
        for (path, said) in [
            (socket.as_path(), "a socket"),
            (&inner, "a folder"),
            (Path::new("/dev/null"), "a device"),
        ] {
            let error = write_whole(path, |writer| writer.write_all(b"x")).unwrap_err();
            assert!(error.to_string().starts_with(said), "{error}");
        }
        let null = Path::new("/dev/null").symlink_metadata().unwrap();
        assert!(null.file_type().is_char_device());
    }
}
