//! What the film or the sensor array makes of the pressure.

include!(concat!(env!("OUT_DIR"), "/sensor.rs"));
