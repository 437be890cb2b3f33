//! The pitch rate is late.
//!
//! All channels late alike is one clock, which nothing shows: what is told is how late this one is beside the others.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "pitch-rate-lag",
        summary: "the pitch rate is late",
        formula: "q(t - tau)",
        signature: "the derivative of the pitch acceleration, in the loads of the axles: little",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
        needs: &[Column::PitchRate],
        looks_like: &["pitch-rate-scale"],
        decides: "one shock that all sensors feel",
        source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of 100 to 1000 Hz",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::PitchRate, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("pitch_rate_radps", 0.2), ("pitch_rate_radps_rate", 0.5)],
        gives: ("pitch_rate_radps", 0.19),
    },
    ..Effect::NEW
};
