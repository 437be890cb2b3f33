//! A bound on the pressure: p <= H with 1/H the parameter, 0 for no bound.

use crate::case::effects::effect::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "hardness",
        summary: "the ice yields under a largest pressure",
        formula: "p <= H, k = 1/H",
        signature: "a plateau in the middle of the map, growing with load",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude(
            "inverse_per_pa",
            "1/Pa",
            0.0,
            1.0e-6,
            2.0e-9,
        )],
        looks_like: &["section-wear", "sensor-blur"],
        decides: "an imprint left in the ice after lifting",
        source: "L. Poirier, E.P. Lozowski, R.I. Thompson, Cold Reg. Sci. Technol. 67 (2011) 129-134; K.L. Johnson, Contact Mechanics (1985), ch. 6",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        let own = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
        problem.ice.hardness = Some(1.0 / (own + value).max(1.0e-12));
    }),
    search: Search {
        growth: Growth::Bent,
        // A bound acts only below the peak: it starts at the largest one measured.
        begins: Some(|problem, largest| {
            let own = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
            (1.0 / largest - own).max(0.0)
        }),
        ..Search::NEW
    },
    example: Example {
        size: 2.0e-8,
        of: "hardness [Pa]",
        measure: Measure::OfProblem(|problem| problem.ice.hardness.unwrap_or(f64::NAN)),
        gives: 5.0e7,
    },
    ..Effect::NEW
};
