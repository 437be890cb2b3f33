//! The yaw gyro reads a share too much or too little: a factor of every turn.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "yaw-rate-scale",
        summary: "the yaw rate is read too large or too small",
        formula: "(1 + k) r",
        signature: "the slip that the yaw rate adds at the axles, and the yaw acceleration",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
        needs: &[Column::YawRate],
        looks_like: &["yaw-inertia", "slip-scale", "speed-scale", "lever-arm"],
        decides: "the sled turned by a known angle",
        source: "data sheets of MEMS gyroscopes: scale factors within 0.1 to 3 %; IEEE Std 952",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::YawRate, 0)],
    example: Example {
        parameters: &[0.05],
        given: &[("yaw_rate_radps", 0.40)],
        gives: ("yaw_rate_radps", 0.42),
    },
    ..Effect::NEW
};
