//! Braking or driving takes grip from the side force: F_x/F_z from the accelerometer, a_x/a_z.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "combined-slip",
        summary: "braking or driving takes grip from the side force",
        formula: "F_y/(1 + k (a_x/a_z)^2)",
        signature: "longitudinal acceleration squared, in curves",
        acts_on: &[ActsOn::Across],
        parameters: &[Parameter::amplitude("factor", "", -5.0, 1.0e3, 0.1)],
        needs: &[Column::LongitudinalAcceleration],
        looks_like: &["saturation"],
        decides: "curves taken with and without braking",
        source: "H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 4 (friction ellipse)",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let ratio = at.acceleration[0] / at.acceleration[2].max(1.0);
        let factor = 1.0 / (1.0 + p[0] * ratio * ratio).max(0.05);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    example: Example {
        parameters: &[100.0],
        given: &[("fy_f_n", 300.0), ("ax_mps2", -2.0), ("az_mps2", 20.0)],
        gives: ("fy_f_n", 150.0),
    },
    ..Effect::NEW
};
