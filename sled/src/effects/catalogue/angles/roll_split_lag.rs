//! The roll-split angle is late.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "roll-split-lag",
        summary: "the roll-split angle is late",
        formula: "gamma(t - tau)",
        signature: "the rate of the roll split times the load of the front",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
        needs: &[Column::RollSplit],
        looks_like: &["camber-thrust", "lever-arm"],
        decides: "one shock that all sensors feel",
        source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of 100 to 1000 Hz",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::RollSplit, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("gamma_rad", 0.03), ("gamma_rad_rate", 0.5)],
        gives: ("gamma_rad", 0.02),
    },
    ..Effect::NEW
};
