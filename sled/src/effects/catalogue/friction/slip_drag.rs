//! Slip brakes more than the side force explains: k is the share of the work of the side force on the slip that ploughs sideways.
//!
//! Slip, side force and load rise in the same curves.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "slip-drag",
        summary: "slip brakes more than the side force explains",
        formula: "F_x - k |F_y alpha| at each runner",
        signature: "slip squared",
        acts_on: &[ActsOn::Along],
        parameters: &[Parameter::amplitude("factor", "", -2.0, 20.0, 0.1)],
        needs: &[Column::Slip],
        looks_like: &["aero-yaw", "load", "steer-drag"],
        decides: "runs of one driver with deliberate drifts on a straight",
        source: "driver evaluation of the bobsled friction model; F. Braghin, F. Cheli, S. Melzi, E. Sabbioni, N. Poerio, The Engineering Approach to Winter Sports (2016)",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        for runner in 0..2 {
            forces.along[runner] -= p[0] * (forces.across[runner] * at.slip[runner]).abs();
        }
    }),
    example: Example {
        parameters: &[0.5],
        given: &[("fy_f_n", -300.0), ("alpha_f_rad", 0.02), ("fx_f_n", -7.0)],
        gives: ("fx_f_n", -10.0),
    },
    ..Effect::NEW
};
