//! What a number may be, and what is said where it is not.

use crate::CaseError;

pub(crate) type Checked = Result<(), CaseError>;

pub(crate) fn modulus(key: &'static str, value: f64) -> Checked {
    require(
        value.is_finite() && value > 0.0,
        key,
        value,
        "a positive modulus in pascals",
    )
}

pub(crate) fn poisson(key: &'static str, value: f64) -> Checked {
    require(
        (0.0..0.5).contains(&value),
        key,
        value,
        "at least 0 and below 0.5",
    )
}

pub(crate) fn positive(key: &'static str, value: f64) -> Checked {
    require(
        value.is_finite() && value > 0.0,
        key,
        value,
        "a positive number",
    )
}

pub(crate) fn radius(key: &'static str, value: f64) -> Checked {
    require(
        value > 0.0,
        key,
        value,
        "a positive radius in metres or inf",
    )
}

pub(crate) fn finite(key: &'static str, value: f64) -> Checked {
    require(value.is_finite(), key, value, "a finite number")
}

pub(crate) fn require(
    holds: bool,
    key: &'static str,
    value: f64,
    expected: &'static str,
) -> Checked {
    if holds {
        return Ok(());
    }
    Err(CaseError::OutOfRange {
        line: 0,
        key,
        value: value.to_string(),
        expected,
    })
}

pub(crate) fn combination(key: &'static str, expected: &'static str) -> CaseError {
    CaseError::Combination {
        line: 0,
        key,
        expected,
    }
}
