//! The runner turned about y by an angle that the model does not have [rad]. With a held tilt the angle adds to it; with a free one the
//! underside is turned against the frame of the map. Signature: the map shifted along the runner. Confounders: a changed rocker. Source: rigid-body geometry.

use std::sync::Arc;

use super::shaped::Shaped;
use super::{Effect, Info};
use crate::{Load, Problem, Tilt};

/// See the module.
pub struct PitchOffset;

static INFO: Info = Info {
    name: "pitch-offset",
    key: "angle_rad",
    unit: "rad",
    low: -0.3,
    high: 0.3,
    typical: 0.002,
    decides: "the runner seen from the side",
};

impl Effect for PitchOffset {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        if let Load::Force {
            tilt: Tilt::Fixed { pitch, .. },
            ..
        } = &mut problem.load
        {
            *pitch += value;
            return;
        }
        let turn = value.tan();
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x, _, height| height - turn * x,
            keeps: [false, true],
        });
    }
}
