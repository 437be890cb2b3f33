//! Contacts on a half-space of ice.

use kufe_contact::{Foundation, Ice, Load, Problem, Runner, Tilt};

use crate::ICE;

/// A runner that is free to tilt, pressed by `fz` [N] onto a track of `track_curvature` [1/m].
pub fn on_half_space(runner: Runner, track_curvature: f64, fz: f64) -> Problem {
    Problem {
        runner,
        ice: Ice {
            youngs_modulus: ICE.0,
            poissons_ratio: ICE.1,
            foundation: Foundation::HalfSpace,
            hardness: None,
        },
        ice_surface: None,
        track_curvature,
        load: Load::Force {
            fz,
            offset_x: 0.0,
            offset_y: 0.0,
            tilt: Tilt::Free,
        },
    }
}
