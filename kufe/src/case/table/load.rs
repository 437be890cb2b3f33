//! What a case says of the load.

use kufe_contact::{Load, Tilt};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

/// The load and what may tilt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("load"))]
#[serde(deny_unknown_fields)]
pub struct LoadTable {
    /// Normal force [N].
    pub fz_n: f64,
    /// Line of action along the runner [m].
    #[serde(default)]
    pub offset_x_m: f64,
    /// Line of action across the runner [m].
    #[serde(default)]
    pub offset_y_m: f64,
    /// Whether pitch and roll settle in equilibrium.
    #[serde(default)]
    pub tilt: TiltWord,
    /// Pitch about y where fixed, positive lowers the nose; 0 where absent [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pitch_rad: Option<f64>,
    /// Roll about x where fixed; 0 where absent [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_rad: Option<f64>,
}

impl LoadTable {
    /// The load of the problem, without effects.
    pub fn load(&self) -> Load {
        Load::Force {
            fz: self.fz_n,
            offset_x: self.offset_x_m,
            offset_y: self.offset_y_m,
            tilt: match self.tilt {
                TiltWord::Free => Tilt::Free,
                TiltWord::Fixed => Tilt::Fixed {
                    pitch: self.pitch_rad.unwrap_or(0.0),
                    roll: self.roll_rad.unwrap_or(0.0),
                },
            },
        }
    }
}

/// Whether the runner may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TiltWord {
    /// Pitch and roll settle where the moments balance.
    #[default]
    Free,
    /// Pitch and roll are fixed.
    Fixed,
}
