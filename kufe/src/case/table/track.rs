//! What a case says of the track.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

/// The track under the runner: a radius or a curvature in the vertical plane, flat where neither is
/// given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("track"))]
#[serde(deny_unknown_fields)]
pub struct TrackTable {
    /// Radius, positive in a valley, `inf` on a straight [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// Curvature, positive in a valley [1/m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curvature_1pm: Option<f64>,
}

impl TrackTable {
    /// Curvature, 0 for an infinite radius and where nothing is given [1/m].
    pub fn curvature(&self) -> f64 {
        match (self.curvature_1pm, self.radius_m) {
            (Some(curvature), _) => curvature,
            (None, Some(radius)) => 1.0 / radius,
            (None, None) => 0.0,
        }
    }
}
