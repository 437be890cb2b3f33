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

/// Reads a recording: Parquet (`.parquet`), MATLAB (`.mat`), MDF 4 (`.mf4`, `.mdf`) or, with any other ending, text.
///
/// Of text, MDF 4 and MATLAB v7.3 only the channels `wanted` by name are read, where some are.
///
/// # Errors
/// Those of the format's reader.
pub fn read_log(
    path: &Path,
    bytes: Vec<u8>,
    options: TextOptions,
    wanted: Option<&[&str]>,
) -> Result<Log, Error> {
    let file = path.display().to_string();
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.unwrap_or("").to_ascii_lowercase().as_str() {
        "parquet" => columns(path, &file),
        "mat" if bytes.starts_with(b"MATLAB 7.3") => matlab73(bytes, wanted, &file),
        "mat" => columns(path, &file),
        "mf4" | "mdf" => mdf4(bytes, wanted, &file),
        _ => read_text(&bytes, options, wanted, &file),
    }
}

#[cfg(feature = "mat73")]
fn matlab73(bytes: Vec<u8>, wanted: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    crate::source::matlab73::read_matlab73(bytes, wanted, file)
}

#[cfg(not(feature = "mat73"))]
fn matlab73(_: Vec<u8>, _: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    Err(Error::file(
        file,
        "this is MATLAB v7.3, which this build does not read (it was made without the feature mat73): save it with save(..., '-v7')",
    ))
}

#[cfg(feature = "mdf4")]
fn mdf4(bytes: Vec<u8>, wanted: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    crate::source::mdf4::read_mdf4(bytes, wanted, file)
}

#[cfg(not(feature = "mdf4"))]
fn mdf4(_: Vec<u8>, _: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    Err(Error::file(
        file,
        "this is MDF, which this build does not read (it was made without the feature mdf4): export it as CSV or Parquet",
    ))
}

/// Reads every channel of a recording.
///
/// # Errors
/// As [`read_log`]; [`Error::File`] where it cannot be read.
pub fn read_recording(path: &Path, options: TextOptions) -> Result<Log, Error> {
    read_log(path, bytes_of(path)?, options, None)
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
