//! The slip angle is late; a relaxation length goes with 1/v and acts on steering too.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "slip-lag",
        summary: "the slip angle is late",
        formula: "alpha(t - tau)",
        signature: "the slip rate",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
        needs: &[Column::Slip],
        looks_like: &["relaxation-length", "yaw-rate-lag", "steer-lag"],
        decides: "the sensor's clock against the gyroscope's on a shaken sled",
        source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of 100 to 1000 Hz",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::Slip, 0)],
    example: Example {
        parameters: &[0.02],
        given: &[("alpha_rad", 0.01), ("alpha_rad_rate", 0.1)],
        gives: ("alpha_rad", 0.008),
    },
    ..Effect::NEW
};
