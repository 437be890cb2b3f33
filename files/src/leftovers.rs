//! Removal of temporary files of processes that were killed.

use std::path::Path;
use std::time::{Duration, SystemTime};

use crate::whole::TEMPORARY;

/// Age since the last write from which a temporary file counts as abandoned.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Removes temporary files and folders of this crate from `folder` that were last written more than
/// a day ago, by processes that were killed. Failures to remove them are ignored.
pub fn clear_temporaries(folder: &Path) {
    clear_older_than(folder, ABANDONED);
}

fn clear_older_than(folder: &Path, age: Duration) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let ours = entry.file_name().to_string_lossy().starts_with(TEMPORARY);
        let Some(found) = entry.metadata().ok().filter(|_| ours) else {
            continue;
        };
        let touched = found.modified().unwrap_or(SystemTime::now());
        if touched.elapsed().unwrap_or_default() >= age {
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
}
