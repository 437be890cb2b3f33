//! The sled touches the wall: a force F before the centre of gravity by a lever x, positive to the left, and the friction f of the bumper.
//!
//! Where the force has a spread from run to run it is half a wave, `F sin^2(pi (s - from) / (to - from))`: a bumper is pressed in and
//! springs back. A run that was recorded has a force and a stretch of its own then, which its side balance sets
//! (`kufe_sled::with_own_contacts`); a run that is simulated has those stated.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "wall-contact",
        summary: "the sled touches the wall",
        formula: "F_y + F, M_z + x F, F_x - f |F|, on a stretch",
        signature: "one place; with a spread in some runs only, harder or softer",
        acts_on: &[ActsOn::Across, ActsOn::Along],
        parameters: &[
            Parameter::amplitude("force_n", "N", -20000.0, 20000.0, 100.0),
            Parameter::FROM,
            Parameter::TO,
            Parameter::setting("friction", "", 0.0, 1.0, 0.0),
            Parameter::setting("lever_m", "m", -3.0, 3.0, 0.0),
            Parameter::SPREAD,
            Parameter::setting("within_m", "m", 0.0, 100.0, 0.0),
        ],
        needs: &[Column::Distance],
        judged: Judged::InWindow,
        looks_like: &["asperities"],
        decides: "a camera, or marks on the wall, at that place",
        source: "the wall contacts near 500 m and 800 m in the validation of the bobsled friction model",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        let along = (at.conditions.s - p[1]) / (p[2] - p[1]);
        if !(0.0..1.0).contains(&along) {
            return;
        }
        let force = match p[5] > 0.0 {
            true => p[0] * (std::f64::consts::PI * along).sin().powi(2),
            false => p[0],
        };
        forces.body_across += force;
        forces.body_yaw += p[4] * force;
        forces.body_along -= p[3] * force.abs();
    }),
    example: Example {
        parameters: &[500.0, 10.0, 30.0, 0.2, 0.1, 300.0, 5.0],
        given: &[("s_m", 20.0)],
        gives: ("fx_n", -100.0),
    },
    ..Effect::NEW
};
