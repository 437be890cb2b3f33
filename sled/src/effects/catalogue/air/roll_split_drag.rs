//! The twisted hull brakes: the drag area grows as the front part turns against the rear.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-split-drag",
        summary: "the twisted hull brakes",
        formula: "F_x - k rho A v^2 |gamma|/2",
        signature: "roll-split angle times v^2",
        acts_on: &[ActsOn::Along],
        parameters: &[Parameter::amplitude(
            "coefficient_per_rad",
            "1/rad",
            -5.0,
            50.0,
            0.02,
        )],
        needs: &[Column::RollSplit],
        looks_like: &["load", "slip-drag"],
        decides: "pressure taps or a tunnel with the front turned",
        source: "A. Sciacchitano, D. Faleo and others on the aerodynamics of bobsleds with a roll split (2018), as cited by the bobsled friction model",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let c = &at.conditions;
        forces.body_along -=
            0.5 * p[0] * c.air_density * c.drag_area * c.v * c.v * at.roll_split.abs();
    }),
    example: Example {
        parameters: &[2.0],
        given: &[
            ("gamma_rad", -0.025),
            ("air_density_kgpm3", 1.25),
            ("cda_m2", 0.2),
            ("v_mps", 40.0),
        ],
        gives: ("fx_n", -10.0),
    },
    ..Effect::NEW
};
