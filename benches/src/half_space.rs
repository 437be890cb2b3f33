//! Contacts on a half-space of ice.

use kufe_contact::{Ice, Load, Problem, Runner, Tilt};

use crate::ICE;

/// A runner that is free to tilt, pressed by `fz` [N] onto a track of `track_curvature` [1/m].
pub fn on_half_space(runner: Runner, track_curvature: f64, fz: f64) -> Problem {
    let ice = Ice::half_space(ICE.0, ICE.1);
    Problem {
        track_curvature,
        ..Problem::new(runner, ice, Load::central(fz, Tilt::Free))
    }
}
