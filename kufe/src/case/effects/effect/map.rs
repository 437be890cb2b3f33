//! Measured pressures.

/// A pressure map on a regular grid, `ny` rows of `nx`, as a film or sensor array gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// Centre of the first pixel along the runner [m].
    pub x0: f64,
    /// Centre of the first pixel across [m].
    pub y0: f64,
    /// Pixel along [m].
    pub dx: f64,
    /// Pixel across [m].
    pub dy: f64,
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
}
