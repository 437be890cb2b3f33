//! Errors of tables, their files, their sweeps and their exports.

use crate::axes::Point;

/// Errors of tables.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The values of an axis are too few, too many or out of range.
    #[error("axis {axis}{problem}")]
    Axis {
        /// The axis.
        axis: &'static str,
        /// What is wrong with it, behind its name.
        problem: String,
    },
    /// An invalid plan, result, table or request; with the value and the expected one.
    #[error("{0}")]
    Invalid(String),
    /// The table has a rocker axis and no rocker radius was given.
    #[error("the table has a rocker radius axis ({low} to {high} m): choose a rocker radius on it")]
    RockerNeeded {
        /// Smallest radius [m].
        low: f64,
        /// Largest radius [m].
        high: f64,
    },
    /// A quantity of sliding contacts in a table of contacts at rest.
    #[error(
        "the table holds contacts at rest: {quantity} expects one of a case with [sliding], over v_mps or ice_c"
    )]
    NoQuantity {
        /// The quantity's name.
        quantity: &'static str,
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
    /// An invalid value in a table file.
    #[error("{key}: found {found}, expected {expected}")]
    Format {
        /// Key or position within the file.
        key: String,
        /// The value found.
        found: String,
        /// The value expected.
        expected: String,
    },
    /// A table file is not the JSON of a table; serde's message has line, column and expectation.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
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
    /// An invalid value of an axis at `index`, from 0.
    pub(crate) fn axis_value(axis: &'static str, index: usize, value: f64, expected: &str) -> Self {
        Error::Axis {
            axis,
            problem: format!(", value {index} = {value}: expected {expected}"),
        }
    }

    /// Reduced curvatures together with axes that exclude them.
    pub(crate) fn flush_plan() -> Self {
        Error::Invalid(
            "flush: expected curvatures from one end to another, and no rocker radii, speeds or \
             temperatures"
                .into(),
        )
    }

    pub(crate) fn node_count(found: usize, expected: usize) -> Self {
        Error::Invalid(format!("{found} nodes for axes that span {expected}"))
    }

    pub(crate) fn rocker_outside(value: f64, span: &str) -> Self {
        Error::Invalid(format!("rocker radius {value} m: the table spans {span}"))
    }

    pub(crate) fn sliding_mixture(point: &Point) -> Self {
        Error::Invalid(format!(
            "{point}: expected figures of sliding at every point, or at none"
        ))
    }

    pub(crate) fn too_large(limit: u64) -> Self {
        Error::Invalid(format!("more than {limit} bytes: expected a smaller file"))
    }

    /// An invalid value, shortened to 120 characters.
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
