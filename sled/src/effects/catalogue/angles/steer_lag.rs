//! The steering angle is late.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "steer-lag",
        summary: "the steering angle is late",
        formula: "delta(t - tau)",
        signature: "the rate of the steering angle, at the front alone",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
        needs: &[Column::Steering],
        looks_like: &["relaxation-length", "slip-lag", "yaw-rate-lag"],
        decides: "the sensor's clock against the gyroscope's on a steered stand",
        source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of 100 to 1000 Hz",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::Steering, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("delta_rad", 0.03), ("delta_rad_rate", 0.5)],
        gives: ("delta_rad", 0.02),
    },
    ..Effect::NEW
};
