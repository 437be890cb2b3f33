//! Estimates with intervals.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// An estimate with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// A value that was held, not estimated.
    pub fn held(value: f64) -> Self {
        Estimate {
            value,
            low: value,
            high: value,
        }
    }

    /// Whether the interval covers `value`.
    pub fn covers(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// Two-sided quantile of Student's t.
pub(crate) fn student_quantile(confidence: f64, freedom: usize) -> f64 {
    match StudentsT::new(0.0, 1.0, freedom.max(1) as f64) {
        Ok(distribution) => distribution.inverse_cdf(0.5 + 0.5 * confidence),
        Err(_) => f64::INFINITY,
    }
}
