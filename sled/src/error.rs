//! Errors of the crate.

use std::fmt::Display;

use crate::fault::Fault;

/// Errors of the sled's readers, models and fits.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be opened, read or written, or has invalid or unsuitable content.
    #[error("{file}: {reason}")]
    File {
        /// The file.
        file: String,
        /// The error of the system or a reader, or what is wrong and what was expected.
        reason: String,
    },
    /// A number of the model is out of its range.
    #[error("{file}: {key} = {value}: expected {expected}")]
    KeyRange {
        /// The file.
        file: String,
        /// The key with its table.
        key: String,
        /// The value found.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// A required column is absent.
    #[error("{file}: column {column} is missing{}; the file has {found}", needs(*.needed_by))]
    MissingColumn {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The columns that are there.
        found: String,
        /// The computation that needs it, where only some do.
        needed_by: Option<&'static str>,
    },
    /// A required table has a column that it should not have, or one twice.
    #[error("{file}: column {column} is {what}; expected {expected}")]
    Column {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// What is wrong with it.
        what: String,
        /// What was expected.
        expected: String,
    },
    /// A cell has an invalid value.
    #[error("{file}: row {row}, column {column}: found {found:?}, expected {expected}")]
    Cell {
        /// The file.
        file: String,
        /// Line in a text file; in other files the row's number, from 1.
        row: u64,
        /// The column.
        column: String,
        /// The value found.
        found: String,
        /// The value expected.
        expected: String,
    },
    /// A row of a file is invalid.
    #[error("{file}: row {row}: {reason}")]
    Row {
        /// The file.
        file: String,
        /// Line in a text file; in other files the row's number, from 1.
        row: u64,
        /// What is wrong, and what was expected.
        reason: String,
    },
    /// A channel provably contradicts its name.
    #[error("{fault}{}", more_faults(*.more))]
    Wrong {
        /// The fault, with its correction.
        fault: Box<Fault>,
        /// Further faults in these runs.
        more: usize,
    },
    /// Two runs have the same samples.
    #[error("runs {first:?} and {second:?} hold the same samples: expected each run once")]
    DuplicateContent {
        /// One run.
        first: String,
        /// The other.
        second: String,
    },
    /// Too few samples, rows or runs, e.g. after filters and exclusions.
    #[error("{what}: {found}, expected at least {needed}")]
    TooFew {
        /// What is counted.
        what: String,
        /// How many remain.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The simulated sled came to rest or went out of the range of the model.
    #[error("simulation stopped at s = {s_m:.1} m, t = {t_s:.2} s: {what}")]
    Stopped {
        /// Distance [m].
        s_m: f64,
        /// Time [s].
        t_s: f64,
        /// Reason.
        what: String,
    },
    /// A number is outside its range.
    #[error("{name} = {value}: expected {expected}")]
    OutOfRange {
        /// Name of the number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// A key of a model is absent.
    #[error("{key} is missing: expected {expected}")]
    MissingKey {
        /// The key.
        key: &'static str,
        /// What was expected.
        expected: &'static str,
    },
    /// Two keys of a model exclude each other.
    #[error("{key} and {other} exclude each other: expected {expected}")]
    KeysExclude {
        /// One key.
        key: &'static str,
        /// The other key.
        other: &'static str,
        /// What was expected.
        expected: &'static str,
    },
    /// The data do not determine what is requested.
    #[error("{what} is not determined by the data: singular value ratio {ratio:.1e}")]
    Undetermined {
        /// What was requested.
        what: &'static str,
        /// Ratio of the smallest to the largest singular value of the scaled design matrix.
        ratio: f64,
    },
    /// A fit failed with the zero offsets of slip angles subtracted, without which it is biased.
    #[error(
        "lateral fit with the zero offsets of slip angles subtracted ({offsets}): {reason}; calibrate the slip and the steering sensor, or leave these sessions out"
    )]
    SlipOffsets {
        /// The offsets.
        offsets: String,
        /// The error of the fit.
        reason: Box<Error>,
    },
    /// An iteration stopped short of its tolerance.
    #[error(
        "{what}: not converged after {iterations} iterations: residual {residual:.2e}, required {tolerance:.2e}"
    )]
    NotConverged {
        /// What was solved for.
        what: &'static str,
        /// Iterations spent.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual required.
        tolerance: f64,
    },
}

fn needs(by: Option<&str>) -> String {
    by.map_or_else(String::new, |by| format!(", which is needed for {by}"))
}

fn more_faults(more: usize) -> String {
    match more {
        0 => String::new(),
        more => format!("; {more} more: kufe runs check shows all"),
    }
}

impl Error {
    /// An error of a file, with the error of the system or a reader.
    pub(crate) fn file(file: impl Display, reason: impl Display) -> Self {
        Error::File {
            file: file.to_string(),
            reason: reason.to_string(),
        }
    }

    /// An invalid row of a file; `row` is the line in the file.
    pub(crate) fn row(file: &str, row: u64, reason: String) -> Self {
        Error::Row {
            file: file.to_string(),
            row,
            reason,
        }
    }

    /// A required column that is not among the columns `found`.
    pub(crate) fn missing_column<'a>(
        file: &str,
        column: &str,
        found: impl IntoIterator<Item = &'a String>,
    ) -> Self {
        let found: Vec<&str> = found.into_iter().map(String::as_str).collect();
        Error::MissingColumn {
            file: file.to_string(),
            column: column.to_string(),
            found: match &found[..] {
                [] => "none".to_string(),
                found => found.join(", "),
            },
            needed_by: None,
        }
    }

    /// A column of a table that is unknown or stated twice.
    pub(crate) fn column(file: &str, column: &str, what: &str, expected: &str) -> Self {
        Error::Column {
            file: file.to_string(),
            column: column.to_string(),
            what: what.to_string(),
            expected: expected.to_string(),
        }
    }

    /// An invalid cell with its value and the expected one; `row` is the line in the file.
    pub(crate) fn cell(
        file: &str,
        row: u64,
        column: &str,
        found: impl Display,
        expected: &str,
    ) -> Self {
        let found = found.to_string();
        Error::Cell {
            file: file.to_string(),
            row,
            column: column.to_string(),
            found: if found.is_empty() {
                "nothing".to_string()
            } else {
                found
            },
            expected: expected.to_string(),
        }
    }

    /// Too few samples, rows or runs.
    pub(crate) fn too_few(what: impl Into<String>, found: usize, needed: usize) -> Self {
        Error::TooFew {
            what: what.into(),
            found,
            needed,
        }
    }
}

/// `Ok` if the value is finite and `valid`.
pub(crate) fn in_range(
    name: &'static str,
    value: f64,
    valid: bool,
    expected: &'static str,
) -> Result<(), Error> {
    let error = Error::OutOfRange {
        name,
        value,
        expected,
    };
    (value.is_finite() && valid).then_some(()).ok_or(error)
}
