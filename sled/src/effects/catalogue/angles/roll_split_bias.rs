//! The roll-split angle has an offset.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-split-bias",
        summary: "the roll-split angle has an offset",
        formula: "gamma + b",
        signature: "the load of the front times a constant, in the front's side force",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("offset_rad", "rad", -0.2, 0.2, 0.002)],
        needs: &[Column::RollSplit],
        looks_like: &["camber-thrust", "steer-offset", "slip-offset"],
        decides: "the sled on level ice",
        source: "zero error of an angle sensor",
        ..Info::NEW
    },
    on_sensors: &[Fault::bias(Sensor::RollSplit, 0)],
    example: Example {
        parameters: &[0.004],
        given: &[("gamma_rad", 0.02)],
        gives: ("gamma_rad", 0.024),
    },
    ..Effect::NEW
};
