//! The sled touches the wall: a force at the centre of gravity, positive to the left, and the friction f of the bumper.

use crate::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "wall-contact",
        summary: "the sled touches the wall",
        formula: "F_y + F, F_x - f |F|, on a stretch",
        signature: "one place",
        acts_on: &[ActsOn::Across, ActsOn::Along],
        parameters: &[
            Parameter::amplitude("force_n", "N", -20000.0, 20000.0, 100.0),
            Parameter::FROM,
            Parameter::TO,
            Parameter::setting("friction", "", 0.0, 1.0, 0.0),
        ],
        needs: &[Column::Distance],
        judged: Judged::InWindow,
        looks_like: &["asperities"],
        decides: "a camera, or marks on the wall, at that place",
        source: "the wall contacts near 500 m and 800 m in the validation of the bobsled friction model",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        if (p[1]..p[2]).contains(&at.conditions.s) {
            forces.body_across += p[0];
            forces.body_along -= p[3] * p[0].abs();
        }
    }),
    example: Example {
        parameters: &[500.0, 10.0, 30.0, 0.2],
        given: &[("s_m", 20.0)],
        gives: ("fx_n", -100.0),
    },
    ..Effect::NEW
};
