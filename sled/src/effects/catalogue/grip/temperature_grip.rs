//! Colder ice is harder and lets the runner cut in less.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "temperature-grip",
        summary: "lateral grip changes with the ice temperature",
        formula: "F_y (1 + k (T_ice - T_ref))",
        signature: "a level from session to session",
        acts_on: &[ActsOn::Across],
        parameters: &[
            Parameter::amplitude("slope_per_k", "1/K", -0.2, 0.2, 0.01),
            Parameter::setting("reference_c", "deg C", -40.0, 0.0, -5.0),
        ],
        needs: &[Column::IceTemperature],
        judged: Judged::BetweenSessions,
        looks_like: &[],
        decides: "sessions at other ice temperatures",
        source: "L. Poirier, E.P. Lozowski, R.I. Thompson, Cold Reg. Sci. Technol. 67 (2011) 129-134",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let factor = 1.0 + p[0] * (at.conditions.ice_c - p[1]);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    example: Example {
        parameters: &[0.02, -5.0],
        given: &[("fy_r_n", 500.0), ("ice_c", -10.0)],
        gives: ("fy_r_n", 450.0),
    },
    ..Effect::NEW
};
