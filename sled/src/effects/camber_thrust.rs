//! F_y,f += k gamma F_z,f. Unit of k: 1/rad. The runner leaning by the roll split cuts sideways. Signature: roll-split angle times load, front only.
//! Confounders: lever arm, noise of the roll-split sensor. Source: H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 4.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct CamberThrust;

static INFO: Info = Info {
    name: "camber-thrust",
    summary: "the turned front runner pushes sideways",
    level: Level::Sample,
    parameters: &[Parameter::amplitude(
        "coefficient_per_rad",
        "1/rad",
        -10.0,
        10.0,
        0.02,
    )],
    needs: &[Column::RollSplit],
    decides: "runs with the roll split locked",
};

impl Effect for CamberThrust {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        forces.across[0] += parameters[0] * at.roll_split * at.load[0];
    }
}
