//! Side forces of the runners.

include!(concat!(env!("OUT_DIR"), "/grip.rs"));
