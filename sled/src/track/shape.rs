//! A track made smooth.

use crate::track::ice::IceAlong;
use crate::track::spline::Spline;
use crate::track::table::Track;

/// A track made smooth: natural cubic splines through the table.
#[derive(Clone, Debug)]
pub struct TrackShape {
    /// Name of the track.
    pub name: String,
    /// Slope [rad].
    pub slope: Spline,
    /// Vertical curvature [1/m].
    pub curvature: Spline,
    /// Bank [rad].
    pub bank: Spline,
    /// Temperature of the ice, where it is stated.
    pub ice: IceAlong,
    /// Distance at the start [m].
    pub start_m: f64,
    /// Distance at the finish [m].
    pub finish_m: f64,
}

impl TrackShape {
    /// Splines through a checked table.
    pub fn new(track: &Track) -> TrackShape {
        let through = |values: &[f64]| Spline::natural(&track.s_m, values);
        TrackShape {
            name: track.name.clone(),
            slope: through(&track.slope_rad),
            curvature: through(&track.curvature_1pm),
            bank: through(&track.bank_rad),
            ice: track.ice.clone(),
            start_m: track.s_m[0],
            finish_m: track.s_m[track.s_m.len() - 1],
        }
    }
}
