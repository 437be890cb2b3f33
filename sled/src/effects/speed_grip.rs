//! F_y' = F_y (1 + k (v - v_ref)). Unit of k: s/m. Signature: over speed. Confounders: load sensitivity, saturation.
//! Source: F. Braghin and others, The Engineering Approach to Winter Sports (2016), lateral friction of bobsled runners.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct SpeedGrip;

static INFO: Info = Info {
    name: "speed-grip",
    summary: "lateral grip changes with speed",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("slope_s_per_m", "s/m", -0.02, 0.2, 0.002),
        Parameter::setting("reference_mps", "m/s", 0.0, 60.0, 25.0),
    ],
    needs: &[Column::Speed],
    decides: "the same curve driven from a lower start",
};

impl Effect for SpeedGrip {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let factor = 1.0 + parameters[0] * (at.conditions.v - parameters[1]);
        for across in &mut forces.across {
            *across *= factor;
        }
    }
}
