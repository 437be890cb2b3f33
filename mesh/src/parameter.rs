//! Numbers that must be positive.

use crate::error::MeshError;

/// `value` where it is positive (infinity allowed).
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, MeshError> {
    if value > 0.0 {
        Ok(value)
    } else {
        Err(MeshError::Parameter {
            name,
            value,
            expected: "a positive number",
        })
    }
}

/// `value` where it is positive and finite.
pub(crate) fn positive_finite(name: &'static str, value: f64) -> Result<f64, MeshError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(MeshError::Parameter {
            name,
            value,
            expected: "a positive, finite number",
        })
    }
}
