//! mu_x' = mu_x (1 + k), F_y' = F_y (1 + k_y) for from_m <= s < to_m: the asperity factors zeta_x = 1 + k and zeta_y = 1 + k_y on a stretch of the track.
//! k and k_y are pure numbers. Signature: one place, the same in every run; the lateral part grows with the slip there. Confounders: wall contact.
//! Source: the asperity factors zeta_x and zeta_y of the bobsled friction model.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct Asperities;

static INFO: Info = Info {
    name: "asperities",
    summary: "a rough stretch of ice",
    level: Level::Track,
    parameters: &[
        Parameter::amplitude("excess", "", -0.9, 20.0, 0.2),
        Parameter::amplitude("grip_excess", "", -0.9, 5.0, 0.05),
        Parameter::setting("from_m", "m", -1.0e5, 1.0e6, 0.0),
        Parameter::setting("to_m", "m", -1.0e5, 1.0e6, 1.0e6),
    ],
    needs: &[Column::Distance],
    decides: "the ice surface looked at, there, and the stretch scraped",
};

impl Effect for Asperities {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        if (parameters[2]..parameters[3]).contains(&at.conditions.s) {
            for runner in 0..2 {
                forces.along[runner] *= 1.0 + parameters[0];
                forces.across[runner] *= 1.0 + parameters[1];
            }
        }
    }
}
