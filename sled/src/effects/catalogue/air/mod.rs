//! Forces of the air.

include!(concat!(env!("OUT_DIR"), "/air.rs"));
