//! sigma/v dF_y/dt + F_y = F_y(alpha), to first order F_y' = F_y - sigma/v dF_y/dalpha dalpha/dt at each runner. Unit of sigma: m.
//! Signature: slip rate over speed. Confounders: lag of the slip sensor (which does not depend on speed).
//! Source: H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 7.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct RelaxationLength;

static INFO: Info = Info {
    name: "relaxation-length",
    summary: "the side force follows the slip after a distance",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("length_m", "m", -5.0, 10.0, 0.05)],
    needs: &[Column::Slip],
    decides: "steering steps at low and at high speed",
};

impl Effect for RelaxationLength {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            let lag = parameters[0] / at.conditions.v.max(1.0);
            forces.across[runner] -= lag * forces.stiffness[runner] * at.slip_rate[runner];
        }
    }
}
