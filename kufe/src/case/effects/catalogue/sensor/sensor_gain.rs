//! The sensor reads a share too much.

use crate::case::effects::effect::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "sensor-gain",
        summary: "the sensor reads a share too much",
        formula: "(1 + k) p",
        signature: "the map does not add up to the load",
        acts_on: &[ActsOn::Map],
        parameters: &[Parameter::amplitude("factor", "", -0.8, 4.0, 0.05)],
        looks_like: &["ice-modulus"],
        decides: "the sensor under a known weight: the map must add up to the load",
        source: "calibration of pressure-sensitive film",
        ..Effect::ON_PRESSURE
    },
    on_map: Some(|value, map| {
        if value == 0.0 {
            return;
        }
        map.pressure.iter_mut().for_each(|p| *p *= 1.0 + value);
    }),
    on_peak: Some(|value| 1.0 + value),
    search: Search {
        adds: Adds::Factors,
        ..Search::NEW
    },
    example: Example {
        size: 0.1,
        of: "sum of the pixels [Pa]",
        measure: Measure::OfMap(|map| map.pressure.iter().sum()),
        gives: 1.1e6,
    },
    ..Effect::NEW
};
