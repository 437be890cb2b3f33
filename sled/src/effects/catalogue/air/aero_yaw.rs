//! The drag grows otherwise with the chassis slip beta: k is added to the 0.0694 a degree of the base model.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "aero-yaw",
        summary: "the drag grows otherwise with the chassis slip",
        formula: "F_x - k |beta| rho A v^2/2, beta in degrees",
        signature: "chassis slip times v^2",
        acts_on: &[ActsOn::Along],
        parameters: &[Parameter::amplitude("per_deg", "1/deg", -0.2, 2.0, 0.02)],
        needs: &[Column::Slip],
        looks_like: &["slip-drag"],
        decides: "a wind tunnel with the sled yawed",
        source: "G. Bello-Millan, T. Makela, L. Parras, C. del Pino, C. Ferrera, J. Wind Eng. Ind. Aerodyn. 157 (2016) 140-144",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let c = &at.conditions;
        let yaw = p[0] * at.chassis_slip.abs().to_degrees();
        forces.body_along -= 0.5 * yaw * c.air_density * c.drag_area * c.v * c.v;
    }),
    example: Example {
        parameters: &[0.05],
        given: &[
            ("alpha_rad", -0.017453292519943295),
            ("air_density_kgpm3", 1.25),
            ("cda_m2", 0.2),
            ("v_mps", 40.0),
        ],
        gives: ("fx_n", -10.0),
    },
    ..Effect::NEW
};
