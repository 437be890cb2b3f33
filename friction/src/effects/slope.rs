//! mu' = mu + k: a slope error k [rad], uphill positive, that an energy balance takes for friction.
//! Signature: a constant, exactly that of a changed level of mu unless both directions are run. Confounders: the level of friction.
//! Source: the paired uphill and downhill glides of the ice-house experiments (a slope of about 0.12 degrees averages out).

use super::{Conditions, Effect, Info, Level, Parameter};

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
    needs: &[],
    decides: "glides in both directions, or a levelled track",
};

impl Effect for Slope {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        let _ = at;
        mu + parameters[0]
    }
}
