//! What can go wrong between a recorded run and a driver's score.

use crate::fault::Fault;

/// Errors of the sled's readers, models and fits.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be opened, read or written, or contradicts itself or what is needed of it.
    #[error("{file}: {reason}")]
    File {
        /// The file.
        file: String,
        /// The answer of the system or a reader, or what is wrong and what was expected.
        reason: String,
    },
    /// A key of the model holds a number that no sled has.
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
    #[error("{file}: column {column} is missing{}; the file has: {found}", needs(*.needed_by))]
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
    /// A cell does not hold what it must.
    #[error("{file}: row {row}, column {column}: found {found:?}, expected {expected}")]
    Cell {
        /// The file.
        file: String,
        /// Line in the file, the header being line 1.
        row: u64,
        /// The column.
        column: String,
        /// The value found.
        found: String,
        /// The value expected.
        expected: String,
    },
    /// Values are missing (NaN or empty); nothing is filled in.
    #[error(
        "{file}: column {column}: {count} values are NaN or missing from row {row} on (t = {t_s:.3} s); {bursts} such bursts in all, {total} values; expected a number in every row: nothing is filled in"
    )]
    Missing {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// Length of the first burst.
        count: usize,
        /// Row of its first value, the header being row 1.
        row: u64,
        /// Time of its first value [s].
        t_s: f64,
        /// Number of bursts.
        bursts: usize,
        /// Missing values in all.
        total: usize,
    },
    /// A channel is provably not what its name says.
    #[error("{fault}{}", more_faults(*.more))]
    Wrong {
        /// What is wrong, and what mends it.
        fault: Box<Fault>,
        /// Further faults in these runs.
        more: usize,
    },
    /// Time is not uniform.
    #[error(
        "{file}: row {row}: {what}: t_s steps by {step_s:.6} s at t = {t_s:.4} s, expected {expected_s:.6} s throughout"
    )]
    Time {
        /// The file.
        file: String,
        /// Row of the later sample, the header being row 1.
        row: u64,
        /// Clock jump, time running backwards, or irregular step.
        what: &'static str,
        /// The step found [s].
        step_s: f64,
        /// Where [s].
        t_s: f64,
        /// The median step [s].
        expected_s: f64,
    },
    /// The sled does not move, where no slip angle exists.
    #[error(
        "{file}: row {row}: v_mps = {v_mps} at t = {t_s:.3} s, expected more than {least} m/s (no slip angle exists at standstill: cut that part off)"
    )]
    Standstill {
        /// The file.
        file: String,
        /// Row, the header being row 1.
        row: u64,
        /// Speed found [m/s].
        v_mps: f64,
        /// When [s].
        t_s: f64,
        /// Least speed accepted [m/s].
        least: f64,
    },
    /// Two rows of the index name the same run.
    #[error(
        "{file}: row {row}: run {run:?} is already named in row {first}, expected each run once"
    )]
    DuplicateRun {
        /// The index.
        file: String,
        /// The later row.
        row: u64,
        /// The name.
        run: String,
        /// The earlier row.
        first: u64,
    },
    /// Two runs hold the same samples.
    #[error("runs {first:?} and {second:?} hold the same samples: expected each run once")]
    DuplicateContent {
        /// One run.
        first: String,
        /// The other.
        second: String,
    },
    /// After filters and exclusions too little remains.
    #[error("{what}: {found}, expected at least {needed}")]
    TooFew {
        /// What there is too little of.
        what: String,
        /// How many remain.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The simulated sled came to rest or went out of the range of the model.
    #[error("simulation stopped at s = {s_m:.1} m, t = {t_s:.2} s: {what}")]
    Stopped {
        /// Where [m].
        s_m: f64,
        /// When [s].
        t_s: f64,
        /// Why.
        what: String,
    },
    /// A run does not lie on the track that it is said to.
    #[error(
        "{file}: begins at s_m = {s_m:.1}, expected a place of track {track}, from {from_m:.1} to {to_m:.1} m"
    )]
    Place {
        /// The file.
        file: String,
        /// Where the run begins [m].
        s_m: f64,
        /// The track.
        track: String,
        /// Where the track begins [m].
        from_m: f64,
        /// Where it ends [m].
        to_m: f64,
    },
    /// A run has no certain place along its track.
    #[error(
        "{file}: matches no place of track {track}, or two: {misfit:.2} of its curvature and bank is unexplained at the best place and {elsewhere:.2} at another, expected below 0.5 and half as much again elsewhere"
    )]
    Unplaced {
        /// The file.
        file: String,
        /// The track.
        track: String,
        /// Unexplained share of the variance at the best place.
        misfit: f64,
        /// The same at the best place elsewhere.
        elsewhere: f64,
    },
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
    /// An error of a file, with the answer of the system or a reader.
    pub(crate) fn file(file: &str, reason: impl std::fmt::Display) -> Self {
        Error::File {
            file: file.to_string(),
            reason: reason.to_string(),
        }
    }

    /// A required column that is not among those `found`.
    pub(crate) fn missing_column<'a>(
        file: &str,
        column: &str,
        found: impl IntoIterator<Item = &'a String>,
    ) -> Self {
        let found: Vec<&str> = found.into_iter().map(String::as_str).collect();
        Error::MissingColumn {
            file: file.to_string(),
            column: column.to_string(),
            found: found.join(", "),
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

    /// What a cell holds and what it must; `row` is the line in the file.
    pub(crate) fn cell(
        file: &str,
        row: u64,
        column: &str,
        found: impl std::fmt::Display,
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

    /// Too little of something.
    pub(crate) fn too_few(what: impl Into<String>, found: usize, needed: usize) -> Self {
        Error::TooFew {
            what: what.into(),
            found,
            needed,
        }
    }
}

/// `Ok` where the value is finite and `holds`.
pub(crate) fn in_range(
    name: &'static str,
    value: f64,
    holds: bool,
    expected: &'static str,
) -> Result<(), Error> {
    let error = Error::OutOfRange {
        name,
        value,
        expected,
    };
    (value.is_finite() && holds).then_some(()).ok_or(error)
}
