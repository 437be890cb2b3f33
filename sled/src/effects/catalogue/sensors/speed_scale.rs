//! The speed is read a share too large or too small, as of a wheel of another radius.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "speed-scale",
        summary: "the speed is read too large or too small",
        formula: "(1 + k) v",
        signature: "v^2 in the drag, the slip that turning adds over 1/v, and the derivative of the speed",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.01)],
        needs: &[Column::Speed],
        looks_like: &["drag-area", "yaw-rate-scale", "slope", "speed-grip"],
        decides: "the time between two marks on the track",
        source: "scale-factor error of a speed sensor, as of an encoder on a wheel of another radius",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::Speed, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("v_mps", 25.0)],
        gives: ("v_mps", 25.5),
    },
    ..Effect::NEW
};
