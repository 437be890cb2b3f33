//! The accelerometer reads a share too much or too little, each axis by its own.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "accelerometer-scale",
        summary: "the accelerometer reads too much or too little",
        formula: "(1 + k_x) a_x, (1 + k_y) a_y, (1 + k_z) a_z",
        signature: "the balance of side force and yaw moment (k_y), loads in curves (k_z), drag and friction alike (k_x)",
        acts_on: &[ActsOn::Sensor],
        parameters: &[
            Parameter::amplitude("x_factor", "", -0.5, 1.0, 0.01),
            Parameter::amplitude("y_factor", "", -0.5, 1.0, 0.01),
            Parameter::amplitude("z_factor", "", -0.5, 1.0, 0.01),
        ],
        needs: &[Column::VerticalAcceleration],
        looks_like: &["mass", "yaw-inertia", "load", "load-sensitivity"],
        decides: "the sensor turned through six positions at rest",
        source: "IEEE Std 1293-2018, linear single-axis accelerometers: scale factor",
        ..Info::NEW
    },
    on_sensors: &[
        Fault::scale(Sensor::Ax, 0),
        Fault::scale(Sensor::Ay, 1),
        Fault::scale(Sensor::Az, 2),
    ],
    example: Example {
        parameters: &[0.0, 0.05, 0.0],
        given: &[("ay_mps2", 4.0)],
        gives: ("ay_mps2", 4.2),
    },
    ..Effect::NEW
};
