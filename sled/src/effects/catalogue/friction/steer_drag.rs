//! Steering brakes: the steered runner scrubs beyond the rotation of its side force.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "steer-drag",
        summary: "steering brakes",
        formula: "F_x,f - k F_z,f |delta|",
        signature: "the steering angle",
        acts_on: &[ActsOn::Along],
        parameters: &[Parameter::amplitude(
            "coefficient_per_rad",
            "1/rad",
            -5.0,
            50.0,
            0.05,
        )],
        needs: &[Column::Steering],
        looks_like: &["slip-drag"],
        decides: "steering pulses on a straight",
        source: "L. Poirier, PhD thesis, University of Calgary (2011)",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        forces.along[0] -= p[0] * at.load[0].max(0.0) * at.steering.abs();
    }),
    example: Example {
        parameters: &[0.1],
        given: &[("fz_f_n", 2000.0), ("delta_rad", -0.02), ("fx_f_n", -8.0)],
        gives: ("fx_f_n", -12.0),
    },
    ..Effect::NEW
};
