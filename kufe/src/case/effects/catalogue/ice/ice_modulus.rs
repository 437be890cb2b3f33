//! Another Young's modulus of the ice.
//!
//! For a rigid runner in the model, a yielding runner is exactly the same.

use crate::case::effects::effect::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "ice-modulus",
        summary: "the ice is stiffer or softer than stated",
        formula: "E (1 + k)",
        signature: "peak pressure up, area down, alike at all loads",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude("factor", "", -0.9, 9.0, 0.1)],
        looks_like: &["runner-compliance", "sensor-gain"],
        decides: "the speed of sound in the ice",
        source: "E.M. Schulson, P. Duval, Creep and Fracture of Ice (2009)",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        problem.ice.youngs_modulus *= 1.0 + value;
    }),
    search: Search {
        adds: Adds::Factors,
        ..Search::NEW
    },
    example: Example {
        size: 0.1,
        of: "Young's modulus of the ice [Pa]",
        measure: Measure::OfProblem(|problem| problem.ice.youngs_modulus),
        gives: 9.9e9,
    },
    ..Effect::NEW
};
