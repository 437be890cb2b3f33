//! Figures read back from a folder that another command has written.

use std::path::Path;

use kufe::jobs::Failure;
use kufe_files::text_of_regular;
use serde::de::DeserializeOwned;

/// The document in a JSON file of at most `longest` bytes.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the key.
pub fn read_json<T: DeserializeOwned>(path: &Path, longest: u64) -> Result<T, Failure> {
    let failure = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let unreadable = |error: std::io::Error| failure(format!("cannot be read: {error}"));
    let text = text_of_regular(path, longest).map_err(unreadable)?;
    serde_json::from_str(&text).map_err(|error| failure(error.to_string()))
}
