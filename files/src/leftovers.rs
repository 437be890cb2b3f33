//! Temporary folders, and removal of those of processes that were killed.

use std::fs::File;
use std::io::{ErrorKind, Result};
use std::path::Path;
use std::time::{Duration, SystemTime};

use tempfile::TempDir;

use crate::whole::TEMPORARY;

/// Age since the last write from which a temporary file counts as abandoned.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// A hidden folder for files that are not whole yet, removed on drop.
///
/// Its process holds a lock on it. On Linux its name has the machine's boot, so that
/// [`clear_temporaries`] knows whose locks it can see.
pub struct TemporaryFolder {
    folder: TempDir,
    _lock: Option<File>,
}

impl TemporaryFolder {
    /// Makes one in `folder`.
    ///
    /// # Errors
    /// The system's where it cannot be made; [`ErrorKind::NotFound`] where another process removed
    /// it before it was locked.
    pub fn new_in(folder: &Path) -> Result<TemporaryFolder> {
        let prefix = prefix_of_boot().unwrap_or_else(|| TEMPORARY.to_owned());
        let made = tempfile::Builder::new()
            .prefix(&prefix)
            .tempdir_in(folder)?;
        let lock = File::open(made.path()).ok();
        let lock = lock.filter(|file| file.lock().is_ok());
        if !made.path().exists() {
            return Err(ErrorKind::NotFound.into());
        }
        Ok(TemporaryFolder {
            folder: made,
            _lock: lock,
        })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// How names of the folders of this boot of this machine begin.
fn prefix_of_boot() -> Option<String> {
    let boot = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    Some(format!("{TEMPORARY}{}-", boot.get(..8)?))
}

/// Removes hidden files and folders of this crate's writers from `folder` that belong to processes
/// that were killed: folders of this boot of this machine that no process has locked, and whatever
/// nobody has touched for a day. What cannot be removed stays.
pub fn clear_temporaries(folder: &Path) {
    clear_older_than(folder, ABANDONED);
}

fn clear_older_than(folder: &Path, age: Duration) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let prefix = prefix_of_boot();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(found) = entry
            .metadata()
            .ok()
            .filter(|_| name.starts_with(TEMPORARY))
        else {
            continue;
        };
        let touched = found.modified().unwrap_or(SystemTime::now());
        let is_old = touched.elapsed().unwrap_or_default() >= age;
        let is_of_boot = prefix
            .as_ref()
            .is_some_and(|prefix| name.starts_with(prefix));
        // The lock lasts until the folder is removed, so that the process that made it notices.
        let unowned = Some(entry.path()).filter(|_| found.is_dir() && is_of_boot);
        let unowned = unowned.and_then(|path| File::open(path).ok());
        let unowned = unowned.filter(|file| file.try_lock().is_ok());
        if is_old || unowned.is_some() {
            let _ = if found.is_dir() {
                std::fs::remove_dir_all(entry.path())
            } else {
                std::fs::remove_file(entry.path())
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_old_temporaries_go() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at(".kufe-old")).unwrap();
        std::fs::write(at(".kufe-old").join("half.vtu"), "half").unwrap();
        std::fs::write(at(".kufe-point"), "half").unwrap();
        std::fs::write(at("mine"), "whole").unwrap();
        clear_temporaries(folder.path());
        assert!(at(".kufe-old").exists() && at(".kufe-point").exists());
        clear_older_than(folder.path(), Duration::ZERO);
        assert!(!at(".kufe-old").exists() && !at(".kufe-point").exists());
        assert!(at("mine").exists());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_is_removed_once_its_process_has_ended() {
        let folder = tempfile::tempdir().unwrap();
        let living = TemporaryFolder::new_in(folder.path()).unwrap();
        let killed = TemporaryFolder::new_in(folder.path()).unwrap();
        let path = killed.path().to_path_buf();
        std::fs::write(path.join("half.vtu"), "half").unwrap();
        // A process that is killed removes nothing, and its locks end.
        let TemporaryFolder {
            folder: hidden,
            _lock,
        } = killed;
        let _ = hidden.keep();
        clear_temporaries(folder.path());
        assert!(path.exists() && living.path().exists());
        drop(_lock);
        clear_temporaries(folder.path());
        assert!(!path.exists() && living.path().exists());
    }
}
