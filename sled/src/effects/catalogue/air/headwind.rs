//! A wind w against the motion, A being the drag area.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "headwind",
        summary: "a wind along the track",
        formula: "F_x - rho A ((v+w)^2 - v^2)/2",
        signature: "v",
        acts_on: &[ActsOn::Along, ActsOn::Friction],
        parameters: &[Parameter::amplitude("speed_mps", "m/s", -15.0, 15.0, 0.5)],
        needs: &[Column::Speed],
        experiments: Experiments::Needs(&[Column::Speed, Column::Load]),
        looks_like: &["drag-area", "speed"],
        decides: "an anemometer at the track, or runs in both directions",
        source: "S.F. Hoerner, Fluid-Dynamic Drag (1965)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        let w = p[0];
        mu + 0.5 * at.air_density * at.drag_area * (2.0 * at.v + w) * w / at.fz.max(1.0)
    }),
    on_forces: Some(|p, at, forces| {
        let c = &at.conditions;
        let w = p[0];
        forces.body_along -= 0.5 * c.air_density * c.drag_area * (2.0 * c.v + w) * w;
    }),
    example: Example {
        parameters: &[2.0],
        given: &[
            ("fx_n", -80.0),
            ("air_density_kgpm3", 1.25),
            ("cda_m2", 0.2),
            ("v_mps", 19.0),
        ],
        gives: ("fx_n", -90.0),
    },
    ..Effect::NEW
};
