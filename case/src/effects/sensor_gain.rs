//! p_measured = (1 + k) p. k is a pure number. Signature: the map does not add up to the load. Confounders: none where the load is known.
//! Source: calibration of pressure-sensitive film.

use super::{Effect, Info, Map};

/// See the module.
pub struct SensorGain;

static INFO: Info = Info {
    name: "sensor-gain",
    key: "factor",
    unit: "",
    low: -0.8,
    high: 4.0,
    typical: 0.05,
    decides: "the sensor under a known weight: the map must add up to the load",
};

impl Effect for SensorGain {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn is_of_the_sensor(&self) -> bool {
        true
    }

    fn sense(&self, value: f64, map: &mut Map) {
        if value == 0.0 {
            return;
        }
        map.pressure.iter_mut().for_each(|p| *p *= 1.0 + value);
    }
}
