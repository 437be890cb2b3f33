//! slope' = slope + k, downhill positive. Unit of k: rad. An accelerometer does not feel it; the speed does.
//! Signature: a constant in the difference of the speed's derivative and the accelerometer. Confounders: accelerometer bias and tilt (of opposite sign).
//! Source: the paired uphill and downhill glides of the ice-house experiments.

use super::{Column, Effect, Info, Level, Parameter};

/// See the module.
pub struct Slope;

static INFO: Info = Info {
    name: "slope",
    summary: "the track is steeper or flatter than stated",
    level: Level::Track,
    parameters: &[Parameter::amplitude(
        "offset_rad",
        "rad",
        -0.05,
        0.05,
        0.0005,
    )],
    needs: &[Column::Slope],
    decides: "a levelled track, or runs in both directions",
};

impl Effect for Slope {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn slope(&self, parameters: &[f64], _s: f64) -> f64 {
        parameters[0]
    }
}
