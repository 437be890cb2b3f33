//! The lower surface of a hull as a height field.

/// The lower surface of a hull as a height over the contact plane.
///
/// Axes: x along the runner, y across, z up; the hull presses downwards. The origin is below the
/// load's line of action, and the lowest point of the hull is near height zero (the solver finds
/// the approach, so the level itself does not matter).
pub trait Underside: Send + Sync {
    /// Height of the lower surface at (`x` [m], `y` [m]), in [m]; `f64::INFINITY` where there is no hull.
    fn height(&self, x: f64, y: f64) -> f64;

    /// The rectangle `[x_min, x_max, y_min, y_max]` [m] that holds the hull; infinite ends are allowed.
    fn extent(&self) -> [f64; 4];

    /// Whether the height is even in x and even in y, to rounding.
    fn mirror_symmetric(&self) -> [bool; 2];

    /// Places (x, y) [m] where a surface through measured points is below what is beside them, along x or across: a burr may lie between any
    /// even lines. None of one that a formula says.
    fn lows(&self) -> &[[f64; 2]] {
        &[]
    }
}
