//! Checks of single numbers, ranges, and evenly spaced numbers.

use crate::error::MeshError;

/// Refuses `value` of the parameter `name` unless it is as `expected`.
pub(crate) fn expect(holds: bool, name: &str, value: f64, expected: &str) -> Result<(), MeshError> {
    if holds {
        Ok(())
    } else {
        Err(MeshError::value(name, value, expected))
    }
}

/// `value` where it is finite.
pub(crate) fn finite(name: &str, value: f64) -> Result<f64, MeshError> {
    expect(value.is_finite(), name, value, "a finite number").map(|()| value)
}

/// `value` where it is positive (infinity allowed).
pub(crate) fn positive(name: &str, value: f64) -> Result<f64, MeshError> {
    expect(value > 0.0, name, value, "a positive number").map(|()| value)
}

/// `value` where it is positive and finite.
pub(crate) fn positive_finite(name: &str, value: f64) -> Result<f64, MeshError> {
    let holds = value > 0.0 && value.is_finite();
    expect(holds, name, value, "a positive, finite number").map(|()| value)
}

/// Smallest and largest of some numbers; infinite and in reverse order where there are none.
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
