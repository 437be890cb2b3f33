//! The friction coefficient, and what brakes along the runners.

include!(concat!(env!("OUT_DIR"), "/friction.rs"));
