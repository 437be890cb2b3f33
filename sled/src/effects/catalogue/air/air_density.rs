//! A relative error k of the air density; within one session exactly what another drag area does.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "air-density",
        summary: "the air density is not the computed one",
        formula: "F_x - k rho A v^2/2",
        signature: "v^2, that of the drag area in one session",
        acts_on: &[ActsOn::Along, ActsOn::Friction],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 0.5, 0.02)],
        needs: &[Column::Speed],
        experiments: Experiments::Needs(&[Column::Speed, Column::Load]),
        looks_like: &["drag-area"],
        decides: "a barometer beside the track",
        source: "ideal gas law with the specific gas constant of air, 287.05 J/(kg K)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        mu + 0.5 * p[0] * at.air_density * at.drag_area * at.v * at.v / at.fz.max(1.0)
    }),
    on_forces: Some(|p, at, forces| {
        let c = &at.conditions;
        forces.body_along -= 0.5 * p[0] * c.air_density * c.drag_area * c.v * c.v;
    }),
    example: Example {
        parameters: &[0.05],
        given: &[
            ("fx_n", -80.0),
            ("air_density_kgpm3", 1.25),
            ("cda_m2", 0.2),
            ("v_mps", 40.0),
        ],
        gives: ("fx_n", -90.0),
    },
    ..Effect::NEW
};
