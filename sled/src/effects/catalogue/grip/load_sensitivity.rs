//! Lateral grip over load is no straight line.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "load-sensitivity",
        summary: "lateral grip changes with the load",
        formula: "F_y (F_z/F_ref)^n",
        signature: "over load",
        acts_on: &[ActsOn::Across],
        parameters: &[
            Parameter::amplitude("exponent", "", -1.5, 1.5, 0.03),
            Parameter::setting("reference_n", "N", 1.0, 20000.0, 2000.0),
        ],
        needs: &[Column::Load],
        looks_like: &["saturation", "speed-grip"],
        decides: "the same runs with ballast",
        source: "H.B. Pacejka, E. Bakker, Vehicle System Dynamics 21 (1992) sup. 1, 1-18",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        for runner in 0..2 {
            forces.across[runner] *= (at.load[runner].max(1.0) / p[1]).powf(p[0]);
        }
    }),
    example: Example {
        parameters: &[-0.5, 2000.0],
        given: &[("fy_f_n", 300.0), ("fz_f_n", 4500.0)],
        gives: ("fy_f_n", 200.0),
    },
    ..Effect::NEW
};
