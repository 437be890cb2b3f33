//! F_y' = F_y (F_z / F_ref)^n at each runner. n is a pure number. Signature: over load. Confounders: saturation, speed grip.
//! Source: H.B. Pacejka, E. Bakker, The magic formula tyre model, Vehicle System Dynamics 21 (1992) sup. 1, 1-18.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct LoadSensitivity;

static INFO: Info = Info {
    name: "load-sensitivity",
    summary: "lateral grip changes with the load",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("exponent", "", -1.5, 1.5, 0.03),
        Parameter::setting("reference_n", "N", 1.0, 20000.0, 2000.0),
    ],
    needs: &[Column::Load],
    decides: "the same runs with ballast",
};

impl Effect for LoadSensitivity {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            forces.across[runner] *= (at.load[runner].max(1.0) / parameters[1]).powf(parameters[0]);
        }
    }
}
