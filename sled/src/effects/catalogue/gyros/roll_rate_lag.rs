//! The roll rate is late.
//!
//! All channels late alike is one clock, which nothing shows: what is told is how late this one is beside the others.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-rate-lag",
        summary: "the roll rate is late",
        formula: "p(t - tau)",
        signature: "the derivative of the roll acceleration, in the lateral reading alone",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
        needs: &[Column::RollRate],
        looks_like: &["lever-arm", "yaw-rate-lag"],
        decides: "one shock that all sensors feel",
        source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of 100 to 1000 Hz",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::RollRate, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("roll_rate_radps", 0.2), ("roll_rate_radps_rate", 0.5)],
        gives: ("roll_rate_radps", 0.19),
    },
    ..Effect::NEW
};
