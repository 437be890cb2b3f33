//! F_x += -k |F_y alpha| at both runners. k is a pure number: the share of the work of the side force on the slip that brakes along the runner
//! (ploughing sideways). Signature: slip squared. Confounders: yawed drag, load, since slip, side force and load rise in the same curves.
//! Source: driver evaluation of the bobsled friction model; F. Braghin, F. Cheli, S. Melzi, E. Sabbioni, N. Poerio, The Engineering Approach to Winter Sports (2016).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct SlipDrag;

static INFO: Info = Info {
    name: "slip-drag",
    summary: "slip brakes more than the side force explains",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("factor", "", -2.0, 20.0, 0.1)],
    needs: &[Column::Slip],
    decides: "runs of one driver with deliberate drifts on a straight",
};

impl Effect for SlipDrag {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            forces.along[runner] -= parameters[0] * (forces.across[runner] * at.slip[runner]).abs();
        }
    }
}
