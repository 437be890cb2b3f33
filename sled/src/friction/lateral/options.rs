//! What is known before the lateral fit.

/// What is known before the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateralFitOptions {
    /// Curvature factor E, predefined and not fitted.
    pub e: f64,
    /// Shape factor C that is held where the data do not determine it.
    pub c: f64,
    /// Standard deviation of the noise in the slip angles as given, after any filter [rad]; 0 where they are exact.
    pub slip_sd: f64,
    /// Probability that the intervals are to cover.
    pub confidence: f64,
}

impl Default for LateralFitOptions {
    fn default() -> Self {
        LateralFitOptions {
            e: 0.99,
            c: 0.05,
            slip_sd: 0.0,
            confidence: 0.95,
        }
    }
}
