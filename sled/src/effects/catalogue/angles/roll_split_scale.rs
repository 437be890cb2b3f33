//! The roll-split angle is read too large or too small.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-split-scale",
        summary: "the roll-split angle is read too large or too small",
        formula: "(1 + k) gamma",
        signature: "the roll split times the load of the front: a camber thrust of the sled's own",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
        needs: &[Column::RollSplit],
        looks_like: &["camber-thrust", "roll-split-drag"],
        decides: "the front turned by a known angle",
        source: "scale-factor error, IEEE Std 1293-2018",
        ..Info::NEW
    },
    on_sensors: &[Fault::scale(Sensor::RollSplit, 0)],
    example: Example {
        parameters: &[0.2],
        given: &[("gamma_rad", 0.01)],
        gives: ("gamma_rad", 0.012),
    },
    ..Effect::NEW
};
