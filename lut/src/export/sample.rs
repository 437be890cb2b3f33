//! One evaluation point of a table.

/// What a runner asks its table at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Normal force [N].
    pub fz: f64,
    /// Curvature of the track [1/m].
    pub curvature: f64,
    /// Speed [m/s]; ignored by tables without that axis.
    pub speed: f64,
    /// Temperature of the ice [C]; ignored by tables without that axis.
    pub ice_c: f64,
}
