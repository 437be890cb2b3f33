//! Another thickness t of the ice layer; 1/t = 0 is a half-space.

use crate::case::effects::effect::prelude::*;
use kufe_contact::Foundation;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "ice-thickness",
        summary: "the ice is thicker or thinner than stated",
        formula: "1/t + k",
        signature: "stiffer under large loads, where the contact is as wide as the layer is thick",
        acts_on: &[ActsOn::Contact],
        parameters: &[Parameter::amplitude(
            "inverse_per_m",
            "1/m",
            -19.0,
            5000.0,
            20.0,
        )],
        looks_like: &["ice-modulus"],
        decides: "a drill hole",
        source: "K.L. Johnson, Contact Mechanics (1985), ch. 5.8",
        ..Effect::ON_PRESSURE
    },
    on_problem: Some(|value, problem| {
        if value == 0.0 {
            return;
        }
        let own = match problem.ice.foundation {
            Foundation::HalfSpace => 0.0,
            Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                1.0 / thickness
            }
        };
        let inverse = own + value;
        let thickness = 1.0 / inverse;
        problem.ice.foundation = match problem.ice.foundation {
            _ if inverse <= 1.0e-6 => Foundation::HalfSpace,
            Foundation::ElasticBed { bed, .. } => Foundation::ElasticBed { thickness, bed },
            _ => Foundation::RigidBed { thickness },
        };
    }),
    // A layer acts once it is as thin as the contact is wide.
    search: Search {
        growth: Growth::Far,
        ..Search::NEW
    },
    example: Example {
        size: 20.0,
        of: "thickness of the layer [m]",
        measure: Measure::OfProblem(|problem| match problem.ice.foundation {
            Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                thickness
            }
            Foundation::HalfSpace => f64::INFINITY,
        }),
        gives: 0.05,
    },
    ..Effect::NEW
};
