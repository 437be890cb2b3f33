//! The steering angle has an offset.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "steer-offset",
        summary: "the steering angle has an offset",
        formula: "delta + b",
        signature: "a constant side force at the front alone",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("offset_rad", "rad", -0.2, 0.2, 0.001)],
        needs: &[Column::Steering],
        looks_like: &["slip-offset", "yaw-rate-bias"],
        decides: "a straight run with the steering clamped",
        source: "zero error of an angle sensor",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::Steering, 0)],
    example: Example {
        parameters: &[0.004],
        given: &[("delta_rad", 0.02)],
        gives: ("delta_rad", 0.024),
    },
    ..Effect::NEW
};
