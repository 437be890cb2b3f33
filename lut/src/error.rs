//! What can go wrong with a table.

/// Errors of tables, their files and their sweeps.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An axis has no values or too many.
    #[error("axis {axis} has {found} values: expected 1 to {limit}")]
    AxisLength {
        /// The axis.
        axis: &'static str,
        /// How many values it has.
        found: usize,
        /// How many it may have.
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
    /// A number of a reduced curvature axis is out of its range.
    #[error("flush.{key} = {value}: expected {expected}")]
    FlushValue {
        /// The number's key.
        key: &'static str,
        /// The value found.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Reduced curvatures were asked of axes that cannot have them.
    #[error(
        "flush: expected curvatures from one end to another, and no rocker radii, speeds or temperatures"
    )]
    FlushPlan,
    /// The axes span more nodes than a table may hold.
    #[error("the axes span {found} nodes: expected at most {limit}")]
    TooManyNodes {
        /// Nodes asked for.
        found: usize,
        /// Nodes allowed.
        limit: usize,
    },
    /// A table has another number of nodes than its axes span.
    #[error("{found} nodes for axes that span {expected}")]
    NodeCount {
        /// Nodes given.
        found: usize,
        /// Nodes that the axes span.
        expected: usize,
    },
    /// A figure of a node or a check is not a finite number.
    #[error("{quantity} at {place} = {value}: expected a finite number")]
    NotFinite {
        /// The quantity's key.
        quantity: &'static str,
        /// Where.
        place: String,
        /// The value found.
        value: f64,
    },
    /// The table has a rocker axis and no rocker radius was chosen.
    #[error("the table has a rocker radius axis ({low} to {high} m): choose a rocker radius on it")]
    RockerNeeded {
        /// Smallest radius [m].
        low: f64,
        /// Largest radius [m].
        high: f64,
    },
    /// A rocker radius was given that the table does not span.
    #[error("rocker radius {value} m: the table spans {span}")]
    RockerOutside {
        /// The radius asked [m].
        value: f64,
        /// What the table has.
        span: String,
    },
    /// A table of contacts at rest was asked for what only a sliding runner has.
    #[error(
        "the table holds contacts at rest: {quantity} expects one of a case with [sliding], over v_mps or ice_c"
    )]
    NoQuantity {
        /// The quantity's name.
        quantity: &'static str,
    },
    /// A lookup over force and curvature was asked of a table with more axes.
    #[error("the table has speeds or temperatures of the ice: expected those to be given")]
    LayersNeeded,
    /// Some points of a table slide and others are at rest.
    #[error("{place}: expected figures of sliding at every point, or at none")]
    SlidingMixture {
        /// The first point that differs.
        place: String,
    },
    /// An interpolation error was asked that is not a positive fraction.
    #[error("interpolation = {value}: expected a relative error between 1e-6 and 0.5")]
    Tolerance {
        /// The value found.
        value: f64,
    },
    /// The refinement reached its limits before its tolerance.
    #[error(
        "interpolation error {measured:.3e} of {quantity} with {nodes} nodes, asked {asked:.3e}: {reason}"
    )]
    ToleranceNotReached {
        /// The quantity that it is asked of.
        quantity: &'static str,
        /// Largest relative error measured.
        measured: f64,
        /// Relative error asked.
        asked: f64,
        /// Nodes placed.
        nodes: usize,
        /// Which limit stopped it.
        reason: &'static str,
    },
    /// A table file is not what it must be.
    #[error("{place}: found {found}, expected {expected}")]
    Format {
        /// Key or position within the file.
        place: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// A file is larger than a reader accepts.
    #[error("more than {limit} bytes: expected a smaller file")]
    TooLarge {
        /// Bytes accepted.
        limit: u64,
    },
    /// A file could not be read or written.
    #[error("{path}: {action}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What failed.
        action: &'static str,
        /// The system's answer.
        source: std::io::Error,
    },
    /// A file of a sweep is damaged.
    #[error("{path}: damaged: {reason}")]
    Corrupt {
        /// The file.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A file of a sweep belongs to another program version or case.
    #[error(
        "{path}: {what} is {found}, that of this program and case is {expected}: the case, a file that it reads or the program has changed since; delete this folder's points to solve them again, or give another output"
    )]
    Mixture {
        /// The file.
        path: String,
        /// Which of its marks differs.
        what: &'static str,
        /// The file's mark.
        found: String,
        /// The plan's mark.
        expected: String,
    },
    /// Points of a plan have no result yet.
    #[error("{missing} of {planned} points of {folder} have no result yet, the first at {first}")]
    Incomplete {
        /// The plan's folder.
        folder: String,
        /// Points without a result.
        missing: usize,
        /// Points planned.
        planned: usize,
        /// The first of them.
        first: String,
    },
    /// A shard number outside the plan.
    #[error("shard {index}/{count}: expected 1/{count} to {count}/{count}")]
    Shard {
        /// Number asked, from 1.
        index: usize,
        /// Number of shards.
        count: usize,
    },
    /// This build carries no compiled library for simulators.
    #[error(
        "this kufe was built where no C compiler was found, so it cannot make an FMU: {reason}; rebuild with a C compiler, or use --header"
    )]
    NoFmuLibrary {
        /// What the build found.
        reason: &'static str,
    },
    /// JSON could not be written.
    #[error("table could not be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// CSV could not be written.
    #[error("table could not be written as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// An archive could not be written.
    #[error("FMU could not be written: {0}")]
    Zip(#[from] zip::result::ZipError),
    /// A stream could not be written.
    #[error("table could not be written: {0}")]
    Write(#[from] std::io::Error),
}
