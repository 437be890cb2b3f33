//! The friction coefficient changes with speed: n = -1/2 for frictional heating with a dry fraction, +1/2 for a sheared film.
//!
//! Speed, time and distance run together on one track: drag area, warm-up and slope look alike.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "speed",
        summary: "friction changes with speed",
        formula: "mu (v/v_ref)^n",
        signature: "over speed",
        acts_on: &[ActsOn::Friction],
        parameters: &[
            Parameter::amplitude("exponent", "", -1.5, 1.5, 0.1),
            Parameter::setting("reference_mps", "m/s", 1.0, 60.0, 25.0),
        ],
        needs: &[Column::Speed],
        looks_like: &["drag-area", "warm-up", "headwind"],
        decides: "runs from a lower start, or a glide on a flat rink with the drag area varied",
        source: "D.C.B. Evans, J.F. Nye, K.J. Cheeseman, Proc. R. Soc. A 347 (1976) 493-512; J.J. de Koning, G. de Groot, G.J. van Ingen Schenau, J. Biomechanics 25 (1992) 565-571",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (at.v.max(0.1) / p[1]).powf(p[0])),
    example: Example {
        parameters: &[0.5, 25.0],
        given: &[("mu", 0.004), ("v_mps", 36.0)],
        gives: ("mu", 0.0048),
    },
    ..Effect::NEW
};
