//! The accelerometer stands at the stated position plus (dx, 0, dz).
//!
//! Noise of the slip angle attenuates forces that the yaw acceleration then shows.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "lever-arm",
        summary: "the accelerometer is not where it is said to be",
        formula: "accelerometer at + (dx, 0, dz)",
        signature: "yaw acceleration (dx), roll acceleration (dz), in the lateral acceleration alone",
        acts_on: &[ActsOn::Sled],
        parameters: &[
            Parameter::amplitude("x_m", "m", -1.5, 1.5, 0.02),
            Parameter::amplitude("z_m", "m", -1.5, 1.5, 0.02),
        ],
        needs: &[Column::RollRate],
        looks_like: &["camber-thrust", "load-transfer", "yaw-inertia"],
        decides: "the sensor's place measured with a tape",
        source: "rigid-body kinematics",
        ..Info::NEW
    },
    on_sled: Some(|p, sled| {
        sled.accelerometer[0] += p[0];
        sled.accelerometer[2] += p[1];
    }),
    example: Example {
        parameters: &[0.05, 0.0],
        given: &[("accel_x_m", -0.35)],
        gives: ("accel_x_m", -0.3),
    },
    ..Effect::NEW
};
