//! The accelerometer reads a constant too much, forward and to the left.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "accelerometer-bias",
        summary: "the accelerometer reads a constant too much",
        formula: "a_x + b, a_y + b",
        signature: "a constant",
        acts_on: &[ActsOn::Sensor],
        parameters: &[
            Parameter::amplitude("x_mps2", "m/s2", -3.0, 3.0, 0.01),
            Parameter::amplitude("y_mps2", "m/s2", -3.0, 3.0, 0.05),
        ],
        looks_like: &["accelerometer-tilt", "slope", "slip-offset", "steer-offset"],
        decides: "the sled at rest on level ice, turned round once",
        source: "IEEE Std 1293-2018, linear single-axis accelerometers",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::Ax, 0), Fault::bias(Sensor::Ay, 1)],
    example: Example {
        parameters: &[0.0, 0.05],
        given: &[("ay_mps2", 4.0)],
        gives: ("ay_mps2", 4.05),
    },
    ..Effect::NEW
};
