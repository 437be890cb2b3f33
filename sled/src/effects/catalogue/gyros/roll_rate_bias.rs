//! The roll gyro reads a constant too much.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-rate-bias",
        summary: "the roll rate has an offset",
        formula: "p + b",
        signature: "the lever of the accelerometer at a constant roll rate: centimetres per second squared, little of which shows",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude(
            "offset_radps",
            "rad/s",
            -0.2,
            0.2,
            0.002,
        )],
        needs: &[Column::RollRate],
        looks_like: &["accelerometer-bias", "yaw-rate-bias"],
        decides: "the sled at rest",
        source: "data sheets of MEMS gyroscopes: rate offsets within 0.1 to 3 deg/s; IEEE Std 952",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::RollRate, 0)],
    example: Example {
        parameters: &[0.01],
        given: &[("roll_rate_radps", 0.2)],
        gives: ("roll_rate_radps", 0.21),
    },
    ..Effect::NEW
};
