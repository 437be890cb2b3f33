//! Groove and melt film instead of a constant: the law that `kufe lut` computes for the runners at hand, switched on by a share.
//!
//! m is what the runner's table of mu says at its load, curvature, speed and ice temperature, over the mean of the table's nodes, so
//! that the level stays the base model's. Speed, load and temperature are its parts, and look like it where little varies.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "film",
        summary: "friction follows groove and melt film, as the runners' tables have them",
        formula: "mu (1 + k (m - 1)), m = mu_table/mean(mu_table)",
        signature: "over speed, load and curvature, and a level from session to session",
        acts_on: &[ActsOn::Friction],
        parameters: &[Parameter::amplitude("share", "", -1.0, 3.0, 0.5)],
        needs: &[Column::Film, Column::Speed],
        experiments: Experiments::Never("its tables are those of a sled's runners"),
        looks_like: &["speed", "load", "temperature", "warm-up"],
        decides: "runs on ice of other temperatures, and from other heights of start",
        source: "E. Lozowski, K. Szilder, S. Maw, Sports Eng. 16 (2013) 239-253; solved for each runner by kufe lut",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (1.0 + p[0] * (at.film - 1.0))),
    example: Example {
        parameters: &[0.5],
        given: &[("mu", 0.004), ("film", 1.5)],
        gives: ("mu", 0.005),
    },
    ..Effect::NEW
};
