//! What can go wrong between a measured table and a friction model.

/// Errors of the friction models, their fits and their readers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number is outside its range.
    #[error("{name} = {value}: expected {expected}")]
    OutOfRange {
        /// What the number is.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
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
    /// A file could not be read or has no readable header.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's or the reader's answer.
        reason: String,
    },
    /// A column is absent.
    #[error("{file}: column {column} is missing, found {found}: expected {expected}")]
    MissingColumn {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The columns that are there.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A column is there that the table does not have.
    #[error("{file}: unknown column {column}: expected {expected}")]
    UnknownColumn {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The columns the table may have.
        expected: String,
    },
    /// A value in a table is not what it must be.
    #[error("{file}: row {row}, column {column}: found {found}, expected {expected}")]
    BadValue {
        /// The file.
        file: String,
        /// Line of the file, the header being line 1.
        row: u64,
        /// The column.
        column: String,
        /// The value found.
        found: String,
        /// The value expected.
        expected: String,
    },
    /// A table has fewer rows than its use needs.
    #[error("{what}: {have} given, expected at least {need}")]
    TooFew {
        /// What there is too little of.
        what: String,
        /// How many there are.
        have: usize,
        /// How many are needed.
        need: usize,
    },
    /// Two runs hold the same samples.
    #[error("runs {first} and {second} hold the same samples: expected each run once")]
    SameSamples {
        /// One run.
        first: String,
        /// The other.
        second: String,
    },
    /// The data do not determine what is requested.
    #[error("{what} is not determined by the data: singular value ratio {ratio:.1e}")]
    Undetermined {
        /// What was requested.
        what: &'static str,
        /// Smallest over largest singular value of the scaled design.
        ratio: f64,
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

/// `Ok` where the value is finite and `holds`.
pub(crate) fn in_range(
    name: &'static str,
    value: f64,
    holds: bool,
    expected: &'static str,
) -> Result<(), Error> {
    if value.is_finite() && holds {
        Ok(())
    } else {
        Err(Error::OutOfRange {
            name,
            value,
            expected,
        })
    }
}
