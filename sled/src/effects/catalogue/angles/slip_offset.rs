//! The slip angle has an offset.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "slip-offset",
        summary: "the slip angle has an offset",
        formula: "alpha + b",
        signature: "a constant side force at both axles",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("offset_rad", "rad", -0.1, 0.1, 0.0005)],
        needs: &[Column::Slip],
        looks_like: &["steer-offset", "accelerometer-bias", "accelerometer-tilt"],
        decides: "a straight run with the steering fixed at zero",
        source: "mounting angle of an optical slip sensor",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::Slip, 0)],
    example: Example {
        parameters: &[0.002],
        given: &[("alpha_rad", 0.01)],
        gives: ("alpha_rad", 0.012),
    },
    ..Effect::NEW
};
