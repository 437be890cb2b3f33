//! The section is worn to a flat of depth d, its edges rounded by max(a, b) = (a + b + sqrt((a - b)^2 + (d/10)^2))/2.
//!
//! Wear leaves no kink, under which the pressure would have no bound. How sharp the edges are is not known: between a kink and
//! this rounding the height at an edge differs by d/20, which a fitted depth may take up; its interval holds that, spread evenly.

use crate::case::effects::effect::prelude::*;
use crate::case::effects::underside::Shaped;

/// Rounding of the flat's edges over its depth.
const ROUNDED: f64 = 0.1;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "section-wear",
        summary: "the section is worn to a flat",
        formula: "max(z, keel + d), edges rounded over d/10",
        signature: "two ridges of pressure at the edges of the flat",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude("depth_m", "m", 0.0, 5.0e-4, 5.0e-6)],
        form: Form::Open(0.5 * ROUNDED / 1.732_050_807_568_877_2),
        looks_like: &["hardness", "roll-tilt"],
        decides: "a profile of the section",
        source: "K.L. Johnson, Contact Mechanics (1985), ch. 2.8 (flat punch with rounded edges)",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        let keel = problem.runner.underside.clone();
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x, _, height: f64| {
                let flat = keel.height(x, 0.0) + value;
                0.5 * (height + flat + (height - flat).hypot(ROUNDED * value))
            },
            keeps: [true, true],
        });
    }),
    // A flat grows with the root of its depth.
    search: Search {
        needs_map: true,
        growth: Growth::Far,
        ..Search::NEW
    },
    example: Example {
        size: 1.0e-5,
        of: "height of the underside at its lowest place [m]",
        measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.0, 0.0)),
        gives: 1.0024937810560446e-5,
    },
    ..Effect::NEW
};
