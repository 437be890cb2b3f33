//! F_y' = F_y / sqrt(1 + kappa (F_y / F_z)^2), kappa = 1/mu_y^2 with mu_y the largest side force over load; front, rear, or both runners alike.
//! kappa is a pure number. Signature: the cube of the side force. Confounders: load sensitivity, a scale error of the slip angle.
//! Source: E. Fiala, Seitenkraefte am rollenden Luftreifen, VDI-Z 96 (1954); H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct Saturation;

static INFO: Info = Info {
    name: "saturation",
    summary: "the side force saturates",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("front", "", -20.0, 2.0e3, 0.2),
        Parameter::amplitude("rear", "", -20.0, 2.0e3, 0.2),
        Parameter::amplitude("both", "", -20.0, 2.0e3, 0.2),
    ],
    needs: &[Column::Slip],
    decides: "drifts at large slip",
};

impl Effect for Saturation {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            let ratio = forces.across[runner] / at.load[runner].max(1.0);
            let kappa = parameters[runner] + parameters[2];
            forces.across[runner] /= (1.0 + kappa * ratio * ratio).max(0.05).sqrt();
        }
    }
}
