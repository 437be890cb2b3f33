//! The yaw gyro reads a constant too much.
//!
//! A constant yaw rate moves the slip angles of the axles apart by a share of 1/v.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "yaw-rate-bias",
        summary: "the yaw rate has an offset",
        formula: "r + b",
        signature: "slip of opposite sign at front and rear, over 1/v",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude(
            "offset_radps",
            "rad/s",
            -0.2,
            0.2,
            0.002,
        )],
        needs: &[Column::YawRate],
        looks_like: &["steer-offset", "slip-offset"],
        decides: "the sled at rest",
        source: "data sheets of MEMS gyroscopes: rate offsets within 0.1 to 3 deg/s; IEEE Std 952",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::YawRate, 0)],
    example: Example {
        parameters: &[0.01],
        given: &[("yaw_rate_radps", 0.40)],
        gives: ("yaw_rate_radps", 0.41),
    },
    ..Effect::NEW
};
