//! The pitch gyro reads a share too much or too little.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "pitch-rate-scale",
        summary: "the pitch rate is read too large or too small",
        formula: "(1 + k) q",
        signature: "loads of the axles by the pitch acceleration, and the curvature where a table asks for it",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
        needs: &[Column::PitchRate],
        looks_like: &["load-sensitivity", "cg-place"],
        decides: "the sled turned about this axis by a known angle",
        source: "data sheets of MEMS gyroscopes: scale factors within 0.1 to 3 %; IEEE Std 952",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::PitchRate, 0)],
    example: Example {
        parameters: &[0.05],
        given: &[("pitch_rate_radps", 0.2)],
        gives: ("pitch_rate_radps", 0.21),
    },
    ..Effect::NEW
};
