//! The yaw rate is late.
//!
//! All channels late alike is one clock, which nothing shows: what is told is how late this one is beside the others.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "yaw-rate-lag",
        summary: "the yaw rate is late",
        formula: "r(t - tau)",
        signature: "the yaw acceleration in the slip of the axles, and its derivative in the balance of moments",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
        needs: &[Column::YawRate],
        looks_like: &[
            "slip-lag",
            "steer-lag",
            "relaxation-length",
            "yaw-inertia",
            "lever-arm",
        ],
        decides: "one shock that all sensors feel",
        source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of 100 to 1000 Hz",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::YawRate, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("yaw_rate_radps", 0.2), ("yaw_rate_radps_rate", 0.5)],
        gives: ("yaw_rate_radps", 0.19),
    },
    ..Effect::NEW
};
