//! What can be wrong with a hull, a mesh or a height map.

use thiserror::Error;

/// Why a hull, a mesh or a height map was refused.
#[derive(Debug, Error)]
pub enum MeshError {
    /// A number out of its range.
    #[error("{name} is {value}; expected {expected}")]
    Parameter {
        /// The parameter's name.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// A point of a profile that does not fit.
    #[error("{name}, point {row}: found {value}; expected {expected}")]
    ProfilePoint {
        /// Which profile.
        name: &'static str,
        /// The point's number, from 1.
        row: usize,
        /// The value found.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// Too few points for what is asked.
    #[error("{name}: {found} points; at least {needed} are needed")]
    TooFewPoints {
        /// What the points describe.
        name: &'static str,
        /// Points found.
        found: usize,
        /// Points needed.
        needed: usize,
    },
}
