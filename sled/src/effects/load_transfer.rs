//! F_y' = F_y / (1 + k phi_dd^2). Unit of k: s4/rad2. Roll acceleration moves load between left and right; with a degressive lateral law the axle loses
//! grip by the square of the shift. Signature: roll acceleration, at the ends of curves. Confounders: camber thrust, lever arm.
//! Source: W.F. Milliken, D.L. Milliken, Race Car Vehicle Dynamics (1995), ch. 7 and 18.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct LoadTransfer;

static INFO: Info = Info {
    name: "load-transfer",
    summary: "roll acceleration shifts load from runner to runner",
    level: Level::Sample,
    parameters: &[Parameter::amplitude(
        "per_radps2_squared",
        "s4/rad2",
        -1.0,
        10.0,
        0.02,
    )],
    needs: &[Column::RollRate],
    decides: "runs with the roll excited on a straight",
};

impl Effect for LoadTransfer {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let factor =
            1.0 / (1.0 + parameters[0] * at.roll_acceleration * at.roll_acceleration).max(0.05);
        for across in &mut forces.across {
            *across *= factor;
        }
    }
}
