//! Lateral grip changes with speed.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "speed-grip",
        summary: "lateral grip changes with speed",
        formula: "F_y (1 + k (v - v_ref))",
        signature: "over speed",
        acts_on: &[ActsOn::Across],
        parameters: &[
            Parameter::amplitude("slope_s_per_m", "s/m", -0.02, 0.2, 0.002),
            Parameter::setting("reference_mps", "m/s", 0.0, 60.0, 25.0),
        ],
        needs: &[Column::Speed],
        looks_like: &["load-sensitivity", "saturation", "speed-scale"],
        decides: "the same curve driven from a lower start",
        source: "F. Braghin and others, The Engineering Approach to Winter Sports (2016), lateral friction of bobsled runners",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let factor = 1.0 + p[0] * (at.conditions.v - p[1]);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    example: Example {
        parameters: &[0.01, 25.0],
        given: &[("fy_r_n", 500.0), ("v_mps", 35.0)],
        gives: ("fy_r_n", 550.0),
    },
    ..Effect::NEW
};
