//! The accelerometer sits askew: pitched by theta (nose down) and rolled by phi (left side up), small angles.
//!
//! On a level track the pitch is exactly an opposite slope.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "accelerometer-tilt",
        summary: "the accelerometer sits askew",
        formula: "a_x - theta a_z, a_y + phi a_z",
        signature: "the vertical acceleration",
        acts_on: &[ActsOn::Sensor],
        parameters: &[
            Parameter::amplitude("pitch_rad", "rad", -0.3, 0.3, 0.001),
            Parameter::amplitude("roll_rad", "rad", -0.3, 0.3, 0.003),
        ],
        needs: &[Column::VerticalAcceleration],
        form: Form::FirstOrder,
        looks_like: &["load", "accelerometer-bias", "slope"],
        decides: "the sled at rest on level ice; a curve with known load",
        source: "IEEE Std 1293-2018, misalignment of the input axis",
        ..Info::NEW
    },
    on_sensors: &[
        Fault::picks_up(Sensor::Ax, Sensor::Az, -1.0, 0),
        Fault::picks_up(Sensor::Ay, Sensor::Az, 1.0, 1),
    ],
    example: Example {
        parameters: &[0.01, 0.0],
        given: &[("ax_mps2", -0.3), ("az_mps2", 20.0)],
        gives: ("ax_mps2", -0.5),
    },
    ..Effect::NEW
};
