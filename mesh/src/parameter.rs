//! Checks of single numbers, and evenly spaced ones.

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

/// `count` equal intervals from `from` to `to`; the last value is exactly `to`, which rounding of
/// the formula may exceed.
pub(crate) fn linspace(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |i| {
        if i == count {
            to
        } else {
            from + (to - from) * i as f64 / count as f64
        }
    })
}
