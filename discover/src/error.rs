//! Errors of reading data and of searches.

use kufe::jobs::Failure;
use std::fmt::Display;
use std::path::Path;

/// Result of a part of a search.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a search fails.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file cannot be read or has invalid content.
    #[error("{file}: {reason}")]
    File {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A cell of a table.
    #[error("{file}: row {row}, column {column}: found {found:?}, expected {expected}")]
    Cell {
        /// The file.
        file: String,
        /// Row, counted from 1 with the header.
        row: u64,
        /// Column.
        column: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A column is missing.
    #[error("{file}: column `{column}` is missing; found {found}")]
    MissingColumn {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The columns present.
        found: String,
    },
    /// Two runs or rows contain the same data, which would inflate significance.
    #[error(
        "{file}: {first} and {second} contain the same data; a copy would count as a second measurement"
    )]
    Duplicate {
        /// The file.
        file: String,
        /// First of the two.
        first: String,
        /// Second of the two.
        second: String,
    },
    /// Too few data.
    #[error("{what}: found {found}, at least {needed} are needed")]
    TooFew {
        /// What there is too little of.
        what: String,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// An unknown effect was requested.
    #[error("effect {name:?}: expected one of {known}")]
    UnknownEffect {
        /// The requested name.
        name: String,
        /// The known names.
        known: String,
    },
    /// The base model cannot be fitted.
    #[error("the base model could not be fitted to the data: {reason}")]
    BaseFit {
        /// The reason.
        reason: String,
    },
    /// From the sled's reader or model.
    #[error(transparent)]
    Sled(#[from] kufe_sled::Error),
    /// From an `[effects]` table.
    #[error(transparent)]
    Effect(#[from] kufe_sled::effects::EffectError),
    /// From the contact solver or its case.
    #[error(transparent)]
    Contact(#[from] kufe_contact::Error),
}

impl Error {
    /// A file that cannot be read or has invalid content.
    pub(crate) fn file(file: &Path, reason: impl Display) -> Self {
        Self::File {
            file: file.display().to_string(),
            reason: reason.to_string(),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::BaseFit { .. } => Failure::NotConverged(error.to_string()),
            Error::UnknownEffect { .. } => Failure::Usage(error.to_string()),
            other => Failure::bad_input(other),
        }
    }
}
