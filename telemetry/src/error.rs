//! Errors of a mapping and of the files that it names.

use kufe_sled::MOST_NUMBERS;

/// Errors of mappings and recordings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A file cannot be read, or is not of its format.
    #[error("{file}: {reason}")]
    File {
        /// The file.
        file: String,
        /// Message of the system or the reader.
        reason: String,
    },
    /// A value of the mapping is invalid.
    #[error("{file}: {key}: found {found}, expected {expected}")]
    Key {
        /// The mapping.
        file: String,
        /// The key with its table.
        key: String,
        /// The value found.
        found: String,
        /// The value expected.
        expected: String,
    },
    /// A recording has no channel of this name.
    #[error("{file}: there is no channel {channel:?}, expected one of: {found}")]
    NoChannel {
        /// The recording.
        file: String,
        /// The name requested.
        channel: String,
        /// The names in the recording.
        found: String,
    },
    /// A cell of a text file is not a number.
    #[error("{file}: row {row}, channel {channel:?}: found {found:?}, expected {expected}")]
    Cell {
        /// The recording.
        file: String,
        /// Line in the file, counted from 1.
        row: u64,
        /// The channel.
        channel: String,
        /// The value found.
        found: String,
        /// The value expected.
        expected: &'static str,
    },
    /// The values of a channel cannot be used.
    #[error("{file}: channel {channel:?}: found {found}, expected {expected}")]
    Channel {
        /// The recording.
        file: String,
        /// The channel.
        channel: String,
        /// The invalid value, with its place.
        found: String,
        /// The expected value.
        expected: String,
    },
    /// The clocks of two loggers cannot be related.
    #[error("run {run}: the clock of logger {logger:?}: {reason}")]
    Clock {
        /// The run.
        run: String,
        /// The logger.
        logger: String,
        /// The reason, and what the mapping may state instead.
        reason: String,
    },
}

impl Error {
    /// An error of a channel's values.
    pub(crate) fn channel(file: &str, channel: &str, found: String, expected: String) -> Self {
        Error::Channel {
            file: file.to_string(),
            channel: channel.to_string(),
            found,
            expected,
        }
    }

    /// The error of recordings with more than [`MOST_NUMBERS`] numbers.
    pub(crate) fn too_many(file: &str) -> Self {
        let reason = format!(
            "the recordings of this run hold more than {MOST_NUMBERS} numbers in the channels that are read, expected \
             fewer; split them, or name fewer channels"
        );
        Error::file(file, reason)
    }

    /// An error of the system or of a format's reader, with its file.
    pub(crate) fn file(file: &str, reason: impl std::fmt::Display) -> Self {
        Error::File {
            file: file.to_string(),
            reason: reason.to_string(),
        }
    }
}
