//! The speed is late.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "speed-lag",
        summary: "the speed is late",
        formula: "v(t - tau)",
        signature: "the acceleration times the delay, a speed that is too low while it grows",
        acts_on: &[ActsOn::Sensor],
        parameters: &[Parameter::amplitude("time_s", "s", -0.5, 1.0, 0.01)],
        needs: &[Column::Speed],
        looks_like: &["slope", "track-profile", "speed-scale"],
        decides: "the time at which a mark on the track is passed",
        source: "filters of satellite receivers and wheel counters: 10 to 200 ms",
        ..Info::NEW
    },
    on_sensors: &[Fault::lag(Sensor::Speed, 0)],
    example: Example {
        parameters: &[0.1],
        given: &[("v_mps", 25.0), ("v_mps_rate", 2.0)],
        gives: ("v_mps", 24.8),
    },
    ..Effect::NEW
};
