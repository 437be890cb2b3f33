//! Friction is higher until the runner has warmed up; tau is the time in which the surface of the steel settles.
//!
//! Speed, distance and slope are tied to time on one track.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "warm-up",
        summary: "friction is higher until the runner has warmed up",
        formula: "mu (1 + k exp(-t/tau))",
        signature: "over time from the start",
        acts_on: &[ActsOn::Friction],
        parameters: &[
            Parameter::amplitude("excess", "", -0.9, 10.0, 0.1),
            Parameter::setting("time_s", "s", 0.1, 1000.0, 10.0).tried(&[3.0, 8.0, 20.0]),
        ],
        needs: &[Column::Time],
        looks_like: &["speed", "slope", "drag-area"],
        decides: "runs with preheated and with cold steel, and a start further down the track",
        source: "E. Lozowski, K. Szilder, S. Maw, Sports Eng. 16 (2013) 239-253 (heat into the blade)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (1.0 + p[0] * (-at.t / p[1]).exp())),
    example: Example {
        parameters: &[0.5, 10.0],
        given: &[("mu", 0.004), ("t_s", 0.0)],
        gives: ("mu", 0.006),
    },
    ..Effect::NEW
};
