//! The runner turned about y by an angle that the model does not have [rad]. With a held tilt the angle adds to it; with a free one the
//! underside is turned against the frame of the map. Signature: the map shifted along the runner. Confounders: a changed rocker. Source: rigid-body geometry.

use super::turned::{About, turn};
use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct PitchOffset;

static INFO: Info = Info {
    name: "pitch-offset",
    key: "angle_rad",
    unit: "rad",
    low: -0.3,
    high: 0.3,
    typical: 1.0e-4,
    decides: "the runner seen from the side",
};

impl Effect for PitchOffset {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        turn(problem, About::Y, value);
    }
}
