//! The steering angle is read too large or too small: the ratio of ropes and linkage.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "steer-scale",
        summary: "the steering angle is read too large or too small",
        formula: "(1 + k) delta",
        signature: "the steering angle, at the front alone",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
        needs: &[Column::Steering],
        looks_like: &["slip-scale", "saturation", "yaw-rate-scale"],
        decides: "the runner turned by a known angle",
        source: "ratio of a steering linkage, scale-factor error, IEEE Std 1293-2018",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::Steering, 0)],
    example: Example {
        parameters: &[0.2],
        given: &[("delta_rad", 0.01)],
        gives: ("delta_rad", 0.012),
    },
    ..Effect::NEW
};
