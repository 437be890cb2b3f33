//! mu' = mu (1 + k) for from_m <= s < to_m: zeta_x = 1 + k of the friction law on a stretch of the track. k is a pure number.
//! Signature: one place, the same in every run. Confounders: an error of the track's profile at that place (where the speed's derivative is used).
//! Source: the asperity factor zeta_x of the longitudinal friction equation of the bobsled friction model.

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Asperities;

static INFO: Info = Info {
    name: "asperities",
    summary: "a rough stretch of ice",
    level: Level::Track,
    parameters: &[
        Parameter::amplitude("excess", "", -0.9, 20.0, 0.2),
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

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        if (parameters[1]..parameters[2]).contains(&at.s) {
            mu * (1.0 + parameters[0])
        } else {
            mu
        }
    }
}
