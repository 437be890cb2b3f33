//! The roll gyro reads a share too much or too little.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-rate-scale",
        summary: "the roll rate is read too large or too small",
        formula: "(1 + k) p",
        signature: "the roll acceleration at the height of the accelerometer, in its lateral reading",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
        needs: &[Column::RollRate],
        looks_like: &["lever-arm", "load-transfer"],
        decides: "the sled turned about this axis by a known angle",
        source: "data sheets of MEMS gyroscopes: scale factors within 0.1 to 3 %; IEEE Std 952",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::RollRate, 0)],
    example: Example {
        parameters: &[0.05],
        given: &[("roll_rate_radps", 0.2)],
        gives: ("roll_rate_radps", 0.21),
    },
    ..Effect::NEW
};
