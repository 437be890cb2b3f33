//! A rough stretch of ice: the asperity factors zeta_x = 1 + k and zeta_y = 1 + k_y of the friction model on a part of the track.
//!
//! The lateral part grows with the slip there.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "asperities",
        summary: "a rough stretch of ice",
        formula: "mu (1 + k), on runs also F_y (1 + k_y), on a stretch",
        signature: "one place, the same in every run",
        acts_on: &[ActsOn::Friction, ActsOn::Across],
        parameters: &[
            Parameter::amplitude("excess", "", -0.9, 20.0, 0.2),
            Parameter::amplitude("grip_excess", "", -0.9, 5.0, 0.05),
            Parameter::FROM,
            Parameter::TO,
        ],
        needs: &[Column::Distance],
        judged: Judged::InWindow,
        looks_like: &["wall-contact", "track-profile"],
        decides: "the ice surface looked at, there, and the stretch scraped",
        source: "the asperity factors zeta_x and zeta_y of the bobsled friction model",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| {
        if (p[2]..p[3]).contains(&at.s) {
            mu * (1.0 + p[0])
        } else {
            mu
        }
    }),
    on_forces: Some(|p, at, forces| {
        if (p[2]..p[3]).contains(&at.conditions.s) {
            for runner in 0..2 {
                forces.along[runner] *= 1.0 + p[0];
                forces.across[runner] *= 1.0 + p[1];
            }
        }
    }),
    example: Example {
        parameters: &[0.5, 0.0, 100.0, 200.0],
        given: &[("mu", 0.004), ("s_m", 150.0)],
        gives: ("mu", 0.006),
    },
    ..Effect::NEW
};
