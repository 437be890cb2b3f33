//! Roll acceleration moves load between left and right; with a degressive lateral law the axle loses grip by the square of the shift.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "load-transfer",
        summary: "roll acceleration shifts load from runner to runner",
        formula: "F_y/(1 + k phi_dd^2)",
        signature: "roll acceleration, at the ends of curves",
        acts_on: &[ActsOn::Across],
        parameters: &[Parameter::amplitude(
            "per_radps2_squared",
            "s4/rad2",
            -1.0,
            10.0,
            0.02,
        )],
        needs: &[Column::RollRate],
        looks_like: &["camber-thrust", "lever-arm"],
        decides: "runs with the roll excited on a straight",
        source: "W.F. Milliken, D.L. Milliken, Race Car Vehicle Dynamics (1995), ch. 7 and 18",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let factor = 1.0 / (1.0 + p[0] * at.roll_acceleration * at.roll_acceleration).max(0.05);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    example: Example {
        parameters: &[0.25],
        given: &[("fy_f_n", 300.0), ("roll_rate_radps_rate", 2.0)],
        gives: ("fy_f_n", 150.0),
    },
    ..Effect::NEW
};
