//! An error dA of the drag area C_x A_x.
//!
//! An apparent friction coefficient takes it for mu: the force over the load.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "drag-area",
        summary: "the drag area is not the stated one",
        formula: "F_x - rho dA v^2/2",
        signature: "v^2",
        acts_on: &[ActsOn::Along, ActsOn::Friction],
        parameters: &[Parameter::amplitude("cda_m2", "m2", -0.5, 0.5, 0.01)],
        needs: &[Column::Speed],
        experiments: Experiments::Needs(&[Column::Speed, Column::Load]),
        looks_like: &["air-density", "speed", "warm-up", "headwind"],
        decides: "a wind tunnel, or runs at one speed with a changed drag area",
        source: "S.F. Hoerner, Fluid-Dynamic Drag (1965)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        mu + 0.5 * at.air_density * p[0] * at.v * at.v / at.fz.max(1.0)
    }),
    on_forces: Some(|p, at, forces| {
        let c = &at.conditions;
        forces.body_along -= 0.5 * c.air_density * p[0] * c.v * c.v;
    }),
    example: Example {
        parameters: &[0.01],
        given: &[
            ("fx_n", -80.0),
            ("air_density_kgpm3", 1.25),
            ("v_mps", 40.0),
        ],
        gives: ("fx_n", -90.0),
    },
    ..Effect::NEW
};
