//! The pitch gyro reads a constant too much.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "pitch-rate-bias",
        summary: "the pitch rate has an offset",
        formula: "q + b",
        signature: "the track's curvature where a table asks for it, over 1/v; little else",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude(
            "offset_radps",
            "rad/s",
            -0.2,
            0.2,
            0.002,
        )],
        needs: &[Column::PitchRate],
        looks_like: &["pitch-rate-scale"],
        decides: "the sled at rest",
        source: "data sheets of MEMS gyroscopes: rate offsets within 0.1 to 3 deg/s; IEEE Std 952",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::PitchRate, 0)],
    example: Example {
        parameters: &[0.01],
        given: &[("pitch_rate_radps", 0.2)],
        gives: ("pitch_rate_radps", 0.21),
    },
    ..Effect::NEW
};
