//! Errors of tables, their files, their sweeps and their exports.

/// What can go wrong with a table.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An axis has no values or too many.
    #[error("axis {axis} has {found} values: expected 1 to {limit}")]
    AxisLength {
        /// The axis.
        axis: &'static str,
        /// Its number of values.
        found: usize,
        /// The largest number of values.
        limit: usize,
    },
    /// An axis value is outside its range or not above the one before.
    #[error("axis {axis}, value {index} = {value}: expected {expected}")]
    AxisValue {
        /// The axis.
        axis: &'static str,
        /// Position on the axis, from 0.
        index: usize,
        /// The value found.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// A parameter of reduced curvatures is out of its range.
    #[error("flush.{key} = {value}: expected {expected}")]
    FlushValue {
        /// The parameter's key.
        key: &'static str,
        /// The value found.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Reduced curvatures together with axes that exclude them.
    #[error(
        "flush: expected curvatures from one end to another, and no rocker radii, speeds or temperatures"
    )]
    FlushPlan,
    /// The axes span more nodes than a table may have.
    #[error("the axes span {found} nodes: expected at most {limit}")]
    TooManyNodes {
        /// Nodes spanned.
        found: usize,
        /// Nodes allowed.
        limit: usize,
    },
    /// A list has another length than the axes span.
    #[error("{found} nodes for axes that span {expected}")]
    NodeCount {
        /// Nodes given.
        found: usize,
        /// Nodes that the axes span.
        expected: usize,
    },
    /// A figure of a node or a check is missing or not a finite number.
    #[error("{quantity} at {place} = {value}: expected a finite number")]
    NotFinite {
        /// The figure's key.
        quantity: &'static str,
        /// The point.
        place: String,
        /// The value found.
        value: f64,
    },
    /// The table has a rocker axis and no rocker radius was given.
    #[error("the table has a rocker radius axis ({low} to {high} m): choose a rocker radius on it")]
    RockerNeeded {
        /// Smallest radius [m].
        low: f64,
        /// Largest radius [m].
        high: f64,
    },
    /// A rocker radius that the table does not span.
    #[error("rocker radius {value} m: the table spans {span}")]
    RockerOutside {
        /// The radius given [m].
        value: f64,
        /// What the table spans.
        span: String,
    },
    /// A quantity of sliding contacts in a table of contacts at rest.
    #[error(
        "the table holds contacts at rest: {quantity} expects one of a case with [sliding], over v_mps or ice_c"
    )]
    NoQuantity {
        /// The quantity's name.
        quantity: &'static str,
    },
    /// Some points of a table slide and others are at rest.
    #[error("{place}: expected figures of sliding at every point, or at none")]
    SlidingMixture {
        /// The first point that differs.
        place: String,
    },
    /// A requested interpolation error that is no positive fraction.
    #[error("interpolation = {value}: expected a relative error between 1e-6 and 0.5")]
    Tolerance {
        /// The value found.
        value: f64,
    },
    /// The refinement reached its limits before its tolerance.
    #[error(
        "interpolation error {measured:.3e} of {quantity} with {nodes} nodes, requested {requested:.3e}: {reason}"
    )]
    ToleranceNotReached {
        /// The quantity that the tolerance applies to.
        quantity: &'static str,
        /// Largest relative error measured.
        measured: f64,
        /// Relative error requested.
        requested: f64,
        /// Nodes placed.
        nodes: usize,
        /// The limit that stopped it.
        reason: &'static str,
    },
    /// A value in a table file is not what it must be.
    #[error("{key}: found {found}, expected {expected}")]
    Format {
        /// Key or position within the file.
        key: String,
        /// What is there.
        found: String,
        /// What must be there.
        expected: String,
    },
    /// A table file is not the JSON of a table; serde's message has line, column and expectation.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// A file is larger than a reader accepts.
    #[error("more than {limit} bytes: expected a smaller file")]
    TooLarge {
        /// Bytes accepted.
        limit: u64,
    },
    /// A path that a script cannot name.
    #[error("{path}: expected a path of printable characters, which a script can name")]
    ScriptPath {
        /// The path, with its control characters escaped.
        path: String,
    },
    /// This build has no compiled library for simulators.
    #[error(
        "this kufe was built where no C compiler was found, so it cannot make an FMU: {reason}; rebuild with a C compiler, or use --header"
    )]
    NoFmuLibrary {
        /// What the build found.
        reason: &'static str,
    },
    /// CSV could not be written.
    #[error("table could not be written as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// An FMU could not be written or read.
    #[error("FMU: {0}")]
    Zip(#[from] zip::result::ZipError),
    /// A stream could not be read or written.
    #[error("input or output failed: {0}")]
    Stream(#[from] std::io::Error),
}

impl Error {
    /// A value that is not what it must be, shortened to 120 characters.
    pub(crate) fn format(key: &str, found: &str, expected: impl Into<String>) -> Self {
        let mut shown: String = found.chars().take(120).collect();
        if shown.len() < found.len() {
            shown += "...";
        }
        Error::Format {
            key: key.into(),
            found: shown,
            expected: expected.into(),
        }
    }
}
