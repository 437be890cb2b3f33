//! Faults of what measures an angle: slip, steering, roll split.

include!(concat!(env!("OUT_DIR"), "/angles.rs"));
