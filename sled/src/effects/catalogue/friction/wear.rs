//! Scratches roughen the polished steel (k > 0); d is the distance run on this finish before the run.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "wear",
        summary: "friction grows with the distance run on one finish",
        formula: "mu (1 + k d)",
        signature: "a level that climbs from run to run",
        acts_on: &[ActsOn::Friction],
        parameters: &[Parameter::amplitude(
            "slope_per_km",
            "1/km",
            -0.2,
            1.0,
            0.02,
        )],
        needs: &[Column::Wear],
        judged: Judged::BetweenRuns,
        looks_like: &["temperature", "humidity"],
        decides: "a run on freshly finished runners late in the session",
        source: "A.-M. Kietzig, S.G. Hatzikiriakos, P. Englezos, J. Appl. Phys. 106 (2009) 024303",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (1.0 + p[0] * at.distance / 1000.0)),
    example: Example {
        parameters: &[0.1],
        given: &[("mu", 0.004), ("distance_m", 2500.0)],
        gives: ("mu", 0.005),
    },
    ..Effect::NEW
};
