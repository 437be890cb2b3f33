//! F_y' = F_y / (1 + k (F_x / F_z)^2) with F_x/F_z from the accelerometer, a_x / a_z. k is a pure number. Signature: longitudinal acceleration squared,
//! in curves. Confounders: saturation. Source: H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 4 (friction ellipse).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct CombinedSlip;

static INFO: Info = Info {
    name: "combined-slip",
    summary: "braking or driving takes grip from the side force",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("factor", "", -5.0, 1.0e3, 0.1)],
    needs: &[Column::LongitudinalAcceleration],
    decides: "curves taken with and without braking",
};

impl Effect for CombinedSlip {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let ratio = at.acceleration[0] / at.acceleration[2].max(1.0);
        let factor = 1.0 / (1.0 + parameters[0] * ratio * ratio).max(0.05);
        for across in &mut forces.across {
            *across *= factor;
        }
    }
}
