//! F_x += -k rho A v^2 |gamma| / 2 on the body. Unit of k: 1/rad. The drag area grows as the front part turns against the rear.
//! Signature: roll-split angle times v^2. Confounders: load and slip drag, in curves.
//! Source: A. Sciacchitano, D. Faleo and others on the aerodynamics of bobsleds with a roll split (2018), as cited by the bobsled friction model.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct RollSplitDrag;

static INFO: Info = Info {
    name: "roll-split-drag",
    summary: "the twisted hull brakes",
    level: Level::Sample,
    parameters: &[Parameter::amplitude(
        "coefficient_per_rad",
        "1/rad",
        -5.0,
        50.0,
        0.02,
    )],
    needs: &[Column::RollSplit],
    decides: "pressure taps or a tunnel with the front turned",
};

impl Effect for RollSplitDrag {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let c = &at.conditions;
        forces.body_along -=
            0.5 * parameters[0] * c.air_density * c.drag_area * c.v * c.v * at.roll_split.abs();
    }
}
