//! F_y += F at the centre of gravity for from_m <= s < to_m, and F_x += -f |F| with the friction f of the bumper. Unit of F: N, positive pushes left.
//! Signature: one place. Confounders: a rough stretch at that place.
//! Source: the wall contacts near 500 m and 800 m in the validation of the bobsled friction model.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct WallContact;

static INFO: Info = Info {
    name: "wall-contact",
    summary: "the sled touches the wall",
    level: Level::Track,
    parameters: &[
        Parameter::amplitude("force_n", "N", -20000.0, 20000.0, 100.0),
        Parameter::setting("from_m", "m", -1.0e5, 1.0e6, 0.0),
        Parameter::setting("to_m", "m", -1.0e5, 1.0e6, 1.0e6),
        Parameter::setting("friction", "", 0.0, 1.0, 0.0),
    ],
    needs: &[Column::Distance],
    decides: "a camera, or marks on the wall, at that place",
};

impl Effect for WallContact {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        if (parameters[1]..parameters[2]).contains(&at.conditions.s) {
            forces.body_across += parameters[0];
            forces.body_along -= parameters[3] * parameters[0].abs();
        }
    }
}
