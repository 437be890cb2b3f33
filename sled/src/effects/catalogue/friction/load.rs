//! The friction coefficient changes with the normal force: n = -1/3 for a line contact with a melt film, near 0 for plowing.
//!
//! Load and side force rise in the same curves: drag of lateral slip looks alike.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "load",
        summary: "friction changes with the normal force",
        formula: "mu (F_z/F_ref)^n",
        signature: "over load, in curves",
        acts_on: &[ActsOn::Friction],
        parameters: &[
            Parameter::amplitude("exponent", "", -1.0, 1.0, 0.05),
            Parameter::setting("reference_n", "N", 1.0, 20000.0, 1000.0),
        ],
        needs: &[Column::Load],
        looks_like: &["plowing", "slip-drag", "accelerometer-tilt"],
        decides: "the same runs with ballast",
        source: "P. Oksanen, J. Keinonen, Wear 78 (1982) 315-324",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (at.fz.max(1.0) / p[1]).powf(p[0])),
    example: Example {
        parameters: &[0.5, 1000.0],
        given: &[("mu", 0.004), ("fz_n", 2250.0)],
        gives: ("mu", 0.006),
    },
    ..Effect::NEW
};
