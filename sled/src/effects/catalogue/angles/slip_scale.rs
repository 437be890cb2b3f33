//! The slip angle is read too large or too small, but not the part that yaw rate and steering add at the axles.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "slip-scale",
        summary: "the slip angle is read too large or too small",
        formula: "(1 + k) alpha",
        signature: "the slip at the sensor",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
        needs: &[Column::Slip],
        looks_like: &["saturation", "yaw-rate-scale"],
        decides: "the sensor turned by a known angle",
        source: "scale-factor error, IEEE Std 1293-2018",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::Slip, 0)],
    example: Example {
        parameters: &[0.2],
        given: &[("alpha_rad", 0.01)],
        gives: ("alpha_rad", 0.012),
    },
    ..Effect::NEW
};
