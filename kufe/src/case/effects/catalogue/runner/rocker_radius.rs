//! The rocker's curvature 1/R is off; the track's vertical curvature adds to it.

use crate::case::effects::effect::prelude::*;
use crate::case::effects::underside::Shaped;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "rocker-radius",
        summary: "the rocker is another",
        formula: "1/R + k: z + k x^2/2",
        signature: "the map longer or shorter along the runner",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude(
            "curvature_1pm",
            "1/m",
            -0.2,
            0.2,
            0.003,
        )],
        looks_like: &["pitch-offset", "waviness"],
        decides: "a straightedge with feeler gauges",
        source: "H. Hertz (1881), by K.L. Johnson, Contact Mechanics (1985), ch. 4",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x, _, height| height + 0.5 * value * x * x,
            keeps: [true, true],
        });
    }),
    example: Example {
        size: 0.02,
        of: "height of the underside at x = 0.1 m [m]",
        measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.1, 0.0)),
        gives: 0.8e-3 / 3.0,
    },
    ..Effect::NEW
};
