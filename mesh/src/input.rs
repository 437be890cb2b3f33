//! Files as bytes.

use std::path::Path;

use kufe_files::read_regular;

use crate::error::MeshError;

/// The bytes of a file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, MeshError> {
    read_regular(path, limit).map_err(|source| MeshError::Io {
        path: path.display().to_string(),
        source,
    })
}

/// The ending of a file's name in lower case.
pub(crate) fn ending(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default();
    ending.to_string_lossy().to_lowercase()
}
