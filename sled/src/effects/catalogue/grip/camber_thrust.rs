//! The turned front runner pushes sideways: leaning by the roll split it cuts in.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "camber-thrust",
        summary: "the turned front runner pushes sideways",
        formula: "F_y,f + k gamma F_z,f",
        signature: "roll-split angle times load, front only",
        acts_on: &[ActsOn::Across],
        parameters: &[Parameter::amplitude(
            "coefficient_per_rad",
            "1/rad",
            -10.0,
            10.0,
            0.02,
        )],
        needs: &[Column::RollSplit],
        looks_like: &["lever-arm", "load-transfer"],
        decides: "runs with the roll split locked",
        source: "H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 4",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        forces.across[0] += p[0] * at.roll_split * at.load[0];
    }),
    example: Example {
        parameters: &[0.5],
        given: &[("fy_f_n", 300.0), ("gamma_rad", -0.02), ("fz_f_n", 2000.0)],
        gives: ("fy_f_n", 280.0),
    },
    ..Effect::NEW
};
