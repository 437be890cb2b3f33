//! A recording by the ending of its name.

use std::path::Path;

use crate::error::Error;
use crate::source::layout::TextOptions;
use crate::source::log::{Channel, Log};
use crate::source::text::read_text;

/// Longest recording [bytes].
const LONGEST: u64 = 4 << 30;

/// A recording's bytes; pipes, devices and files beyond 4 GiB are refused.
///
/// # Errors
/// [`Error::File`].
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, Error> {
    kufe_files::read_regular(path, LONGEST)
        .map_err(|error| Error::file(&path.display().to_string(), error))
}

/// Reads a recording: Parquet, MATLAB, MDF 4 or, with any other ending, text.
///
/// Of text only the channels `wanted` by name are read, where some are.
///
/// # Errors
/// Those of the format's reader.
pub fn read_log(
    path: &Path,
    bytes: &[u8],
    options: TextOptions,
    wanted: Option<&[&str]>,
) -> Result<Log, Error> {
    let file = path.display().to_string();
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.unwrap_or("").to_ascii_lowercase().as_str() {
        "parquet" => columns(path, &file),
        "mat" => columns(path, &file),
        _ => read_text(bytes, options, wanted, &file),
    }
}

/// Reads every channel of a recording.
///
/// # Errors
/// As [`read_log`]; [`Error::File`] where it cannot be read.
pub fn read_recording(path: &Path, options: TextOptions) -> Result<Log, Error> {
    read_log(path, &bytes_of(path)?, options, None)
}

/// Columns without units.
fn columns(path: &Path, file: &str) -> Result<Log, Error> {
    let columns = kufe_sled::read_columns(path, &[]).map_err(|error| Error::file(file, error))?;
    let channels = columns.into_iter().map(|(name, values)| Channel {
        name,
        unit: None,
        clock: None,
        values,
    });
    Ok(Log {
        channels: channels.collect(),
        ..Log::default()
    })
}
