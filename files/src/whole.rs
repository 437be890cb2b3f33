//! Atomic writing of files.

use std::io::{BufWriter, Result, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use crate::place::{folder_of, replaceable};

/// Prefix of the names of temporary files and folders.
pub const TEMPORARY: &str = ".kufe-";

/// Writes `path` atomically: through a temporary file in its folder, which is flushed to the disk
/// and renamed when it is complete.
///
/// Several processes, on several machines, may write one path at a time: the file of the last to
/// finish remains. The process's umask determines the permissions, as for any other new file. If
/// `path` is a link, its target is written and the link remains.
///
/// # Errors
/// Those of `write`; [`ErrorKind::InvalidInput`](std::io::ErrorKind::InvalidInput) for a folder, a
/// device, a pipe and a link whose target does not exist; the system's error if the folder is
/// missing or the file cannot be written. No temporary file remains.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    let path = &replaceable(path)?;
    let temporary = temporary_in(folder_of(path))?;
    let mut writer = BufWriter::new(temporary.as_file());
    write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// A hidden file in `folder`, with the permissions of any other new file.
///
/// # Errors
/// The error of the operating system if it cannot be created.
pub fn temporary_in(folder: &Path) -> Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system removes the bits of the umask.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<std::ffi::OsString> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name()).collect()
    }

    #[test]
    fn a_file_that_fails_halfway_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.txt");
        write_whole(&path, |writer| writer.write_all(b"before")).unwrap();
        let failed = write_whole(&path, |writer| {
            writer.write_all(b"after")?;
            Err(std::io::Error::other("no more"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "no more");
        assert_eq!(std::fs::read(&path).unwrap(), b"before");
        assert_eq!(names(folder.path()), ["result.txt"]);
    }

    #[test]
    fn a_missing_folder_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none").join("result.txt");
        assert!(write_whole(&path, |_| Ok(())).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_may_be_read_by_whom_any_other_new_file_may() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| {
            let found = std::fs::metadata(folder.path().join(name)).unwrap();
            found.permissions().mode() & 0o777
        };
        std::fs::write(folder.path().join("ordinary"), "").unwrap();
        write_whole(&folder.path().join("whole"), |_| Ok(())).unwrap();
        assert_eq!(mode("whole"), mode("ordinary"));
        assert_eq!(mode("whole") & 0o111, 0);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_written_through_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, "before").unwrap();
        std::os::unix::fs::symlink("file", &link).unwrap();
        write_whole(&link, |writer| writer.write_all(b"after")).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"after");
        assert!(link.symlink_metadata().unwrap().is_symlink());
        let lost = folder.path().join("lost");
        std::os::unix::fs::symlink("nowhere", &lost).unwrap();
        let error = write_whole(&lost, |writer| writer.write_all(b"x")).unwrap_err();
        assert!(error.to_string().contains("leads nowhere"), "{error}");
        assert!(lost.symlink_metadata().unwrap().is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn folders_sockets_and_devices_are_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let inner = folder.path().join("folder");
        std::fs::create_dir(&inner).unwrap();
        for (path, printed) in [
            (socket.as_path(), "a socket"),
            (&inner, "a folder"),
            (Path::new("/dev/null"), "a device"),
        ] {
            let error = write_whole(path, |writer| writer.write_all(b"x")).unwrap_err();
            assert!(error.to_string().starts_with(printed), "{error}");
        }
        let null = Path::new("/dev/null").symlink_metadata().unwrap();
        assert!(std::os::unix::fs::FileTypeExt::is_char_device(
            &null.file_type()
        ));
    }
}
