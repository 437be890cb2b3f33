//! Frost grows from humid air and roughens the ice (k > 0); h is the relative humidity.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "humidity",
        summary: "friction changes with the humidity of the air",
        formula: "mu (1 + k (h - h_ref))",
        signature: "a level from session to session",
        acts_on: &[ActsOn::Friction],
        parameters: &[
            Parameter::amplitude("slope_per_pct", "1/%", -0.05, 0.05, 0.002),
            Parameter::setting("reference_pct", "%", 0.0, 100.0, 70.0),
        ],
        needs: &[Column::Humidity],
        judged: Judged::BetweenSessions,
        looks_like: &["temperature"],
        decides: "sessions of equal ice temperature and different humidity",
        source: "A.-M. Kietzig, S.G. Hatzikiriakos, P. Englezos, J. Appl. Phys. 107 (2010) 081101",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (1.0 + p[0] * (at.humidity_pct - p[1]))),
    example: Example {
        parameters: &[0.01, 70.0],
        given: &[("mu", 0.004), ("humidity_pct", 80.0)],
        gives: ("mu", 0.0044),
    },
    ..Effect::NEW
};
