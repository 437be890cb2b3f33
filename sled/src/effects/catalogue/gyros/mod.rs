//! Faults of the three gyroscopes.

include!(concat!(env!("OUT_DIR"), "/gyros.rs"));
