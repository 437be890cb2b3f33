//! The conditions under which a runner glides.

/// What a friction coefficient may depend on; NaN where a quantity is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Time since the start of the run [s].
    pub t: f64,
    /// Distance along the track [m].
    pub s: f64,
    /// Speed [m/s].
    pub v: f64,
    /// Normal force of the runner, or of the whole sled for a glide [N].
    pub fz: f64,
    /// Ice temperature [deg C].
    pub ice_c: f64,
    /// Air temperature [deg C].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Relative humidity [%].
    pub humidity_pct: f64,
    /// Distance run on this finish before the run [m].
    pub distance: f64,
    /// Air density [kg/m3].
    pub air_density: f64,
    /// Drag area of the base model [m2].
    pub drag_area: f64,
    /// Friction of groove and film as the runner's table has it, over the table's mean.
    pub film: f64,
}
