//! Faults of sensors.

include!(concat!(env!("OUT_DIR"), "/sensors.rs"));
