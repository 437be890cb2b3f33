//! The side force saturates: kappa = 1/mu_y^2 with mu_y the largest side force over load; front, rear, or both runners alike.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "saturation",
        summary: "the side force saturates",
        formula: "F_y/sqrt(1 + kappa (F_y/F_z)^2), kappa = 1/mu_y^2",
        signature: "the cube of the side force",
        acts_on: &[ActsOn::Across],
        parameters: &[
            Parameter::amplitude("front", "", -20.0, 2.0e3, 0.2),
            Parameter::amplitude("rear", "", -20.0, 2.0e3, 0.2),
            Parameter::amplitude("both", "", -20.0, 2.0e3, 0.2),
        ],
        needs: &[Column::Slip],
        looks_like: &["load-sensitivity", "slip-scale"],
        decides: "drifts at large slip",
        source: "E. Fiala, VDI-Z 96 (1954); H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012)",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        for runner in 0..2 {
            let ratio = forces.across[runner] / at.load[runner].max(1.0);
            let kappa = p[runner] + p[2];
            forces.across[runner] /= (1.0 + kappa * ratio * ratio).max(0.05).sqrt();
        }
    }),
    example: Example {
        parameters: &[0.0, 0.0, 300.0],
        given: &[("fy_r_n", 200.0), ("fz_r_n", 2000.0)],
        gives: ("fy_r_n", 100.0),
    },
    ..Effect::NEW
};
