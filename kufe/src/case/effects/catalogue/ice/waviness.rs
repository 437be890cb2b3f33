//! Waves along the track, 50 mm long.

use crate::case::effects::effect::prelude::*;
use crate::case::effects::underside::Shaped;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "waviness",
        summary: "the ice is wavy",
        formula: "z + a (cos(2 pi x / 50 mm) - 1)",
        signature: "the pressure modulated along the runner",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude(
            "amplitude_m",
            "m",
            -1.0e-4,
            1.0e-4,
            1.0e-6,
        )],
        looks_like: &["rocker-radius"],
        decides: "the ice seen under grazing light",
        source: "H.M. Westergaard, J. Appl. Mech. 6 (1939) 49-53",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        let number = std::f64::consts::TAU / 0.05;
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x: f64, _, height| height + value * ((number * x).cos() - 1.0),
            keeps: [true, true],
        });
    }),
    search: Search {
        needs_map: true,
        ..Search::NEW
    },
    example: Example {
        size: 1.0e-6,
        of: "height of the underside at x = 25 mm [m]",
        measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.025, 0.0)),
        gives: 8.416666666666667e-6,
    },
    ..Effect::NEW
};
