//! Checks of single numbers, ranges, and evenly spaced numbers.

use crate::error::MeshError;

/// The error of the parameter `name` if `valid` is false: its `value` and what was `expected`.
pub(crate) fn expect(valid: bool, name: &str, value: f64, expected: &str) -> Result<(), MeshError> {
    if valid {
        Ok(())
    } else {
        Err(MeshError::value(name, value, expected))
    }
}

/// `value`, which must be finite.
pub(crate) fn finite(name: &str, value: f64) -> Result<f64, MeshError> {
    expect(value.is_finite(), name, value, "a finite number").map(|()| value)
}

/// `value`, which must be positive (infinity allowed).
pub(crate) fn positive(name: &str, value: f64) -> Result<f64, MeshError> {
    expect(value > 0.0, name, value, "a positive number").map(|()| value)
}

/// `value`, which must be positive and finite.
pub(crate) fn positive_finite(name: &str, value: f64) -> Result<f64, MeshError> {
    let valid = value > 0.0 && value.is_finite();
    expect(valid, name, value, "a positive, finite number").map(|()| value)
}

/// Smallest and largest of some numbers; [inf, -inf] if there are none.
pub(crate) fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let both = values.into_iter();
    both.fold(none, |[low, high], v| [low.min(v), high.max(v)])
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
