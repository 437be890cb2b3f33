//! The runner gives k times as much as the ice: about 0.04 for steel on ice as a block, more where the runner bends.

use crate::case::effects::effect::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "runner-compliance",
        summary: "the runner yields elastically under its load",
        formula: "E*/(1 + k)",
        signature: "that of a softer ice",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude("factor", "", 0.0, 3.0, 0.1)],
        looks_like: &["ice-modulus"],
        decides: "the same runner on a plate of known modulus",
        source: "K.L. Johnson, Contact Mechanics (1985), ch. 4.2",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        problem.ice.youngs_modulus /= 1.0 + value;
    }),
    search: Search {
        adds: Adds::Factors,
        ..Search::NEW
    },
    example: Example {
        size: 0.25,
        of: "Young's modulus of the ice [Pa]",
        measure: Measure::OfProblem(|problem| problem.ice.youngs_modulus),
        gives: 7.2e9,
    },
    ..Effect::NEW
};
