//! The runner turned about x by an angle that the model does not have [rad]. With a held tilt the angle adds to it; with a free one the
//! underside is turned against the frame of the map. Signature: the map shifted across and skewed. Confounders: a worn side of the section. Source: rigid-body geometry.

use super::turned::{About, turn};
use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct RollTilt;

static INFO: Info = Info {
    name: "roll-tilt",
    key: "angle_rad",
    unit: "rad",
    low: -0.3,
    high: 0.3,
    typical: 0.002,
    decides: "the runner seen from the front",
};

impl Effect for RollTilt {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        turn(problem, About::X, value);
    }
}
