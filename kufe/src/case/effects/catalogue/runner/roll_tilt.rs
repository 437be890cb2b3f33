//! The runner turned about x by an angle that the model does not have.
//!
//! With a held tilt the angle adds to it; with a free one the underside is turned against the frame of the map.

use crate::case::effects::effect::prelude::*;
use crate::case::effects::underside::{About, turn};

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-tilt",
        summary: "the runner is rolled",
        formula: "held roll + a",
        signature: "the map shifted across and skewed",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude("angle_rad", "rad", -0.3, 0.3, 0.002)],
        looks_like: &["section-wear"],
        decides: "the runner seen from the front",
        source: "rigid-body geometry",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| turn(problem, About::X, value)),
    search: Search {
        needs_map: true,
        ..Search::NEW
    },
    example: Example {
        size: 0.1,
        of: "height of the underside 1 mm to the left [m]",
        measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.0, 0.001)),
        gives: 2.0033467208545054e-4,
    },
    ..Effect::NEW
};
