//! The friction coefficient changes with the ice temperature.
//!
//! Friction on ice has a minimum at a few degrees below zero and grows towards cold ice (k < 0) as the melt film thins.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "temperature",
        summary: "friction changes with the ice temperature",
        formula: "mu (1 + k (T_ice - T_ref))",
        signature: "a level from session to session",
        acts_on: &[ActsOn::Friction],
        parameters: &[
            Parameter::amplitude("slope_per_k", "1/K", -0.2, 0.2, 0.01),
            Parameter::setting("reference_c", "deg C", -40.0, 0.0, -5.0),
        ],
        needs: &[Column::IceTemperature],
        judged: Judged::BetweenSessions,
        looks_like: &["humidity", "wear"],
        decides: "sessions at other ice temperatures with the other conditions held",
        source: "M. Akkok, C.M. McC. Ettles, S.J. Calabrese, J. Tribology 109 (1987) 552-561; L. Poirier, PhD thesis, University of Calgary (2011)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| mu * (1.0 + p[0] * (at.ice_c - p[1]))),
    example: Example {
        parameters: &[0.01, -5.0],
        given: &[("mu", 0.004), ("ice_c", -10.0)],
        gives: ("mu", 0.0038),
    },
    ..Effect::NEW
};
