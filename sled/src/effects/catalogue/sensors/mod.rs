//! Faults of accelerometer and speed sensor.

include!(concat!(env!("OUT_DIR"), "/sensors.rs"));
