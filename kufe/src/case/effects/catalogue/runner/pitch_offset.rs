//! The runner turned about y by an angle that the model does not have.
//!
//! With a held tilt the angle adds to it; with a free one the underside is turned against the frame of the map.

use crate::case::effects::effect::prelude::*;
use crate::case::effects::underside::{About, turn};

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "pitch-offset",
        summary: "the runner is pitched",
        formula: "held pitch + a",
        signature: "the map shifted along the runner",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude("angle_rad", "rad", -0.3, 0.3, 1.0e-4)],
        looks_like: &["rocker-radius"],
        decides: "the runner seen from the side",
        source: "rigid-body geometry",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| turn(problem, About::Y, value)),
    search: Search {
        needs_map: true,
        ..Search::NEW
    },
    example: Example {
        size: 0.1,
        of: "height of the underside 6 mm ahead [m]",
        measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.006, 0.0)),
        gives: -6.0140803251270e-4,
    },
    ..Effect::NEW
};
