//! The speed is read a constant too high.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "speed-bias",
        summary: "the speed has an offset",
        formula: "v + b",
        signature: "the slip that turning adds over 1/v, and the drag over v",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("offset_mps", "m/s", -5.0, 5.0, 0.1)],
        needs: &[Column::Speed],
        looks_like: &["speed-scale", "drag-area", "headwind"],
        decides: "the time between two marks on the track, at two speeds",
        source: "zero error of a Doppler or optical speed sensor, data sheets: 0.05 to 0.5 m/s",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::Speed, 0)],
    example: Example {
        parameters: &[0.5],
        given: &[("v_mps", 25.0)],
        gives: ("v_mps", 25.5),
    },
    ..Effect::NEW
};
