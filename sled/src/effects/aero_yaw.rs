//! F_x += -k |beta| rho A v^2 / 2, beta in degrees. Unit of k: 1/deg, added to the 0.0694 of the base model. Signature: chassis slip times v^2.
//! Confounders: slip drag. Source: G. Bello-Millan, T. Makela, L. Parras, C. del Pino, C. Ferrera, Experimental study on Ahmed body drag coefficient
//! for different yaw angles, J. Wind Eng. Ind. Aerodyn. 157 (2016) 140-144.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct AeroYaw;

static INFO: Info = Info {
    name: "aero-yaw",
    summary: "the drag grows otherwise with the chassis slip",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("per_deg", "1/deg", -0.2, 2.0, 0.02)],
    needs: &[Column::Slip],
    decides: "a wind tunnel with the sled yawed",
};

impl Effect for AeroYaw {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let c = &at.conditions;
        let yaw = parameters[0] * at.chassis_slip.abs().to_degrees();
        forces.body_along -= 0.5 * yaw * c.air_density * c.drag_area * c.v * c.v;
    }
}
