//! The runner: its shape, how it is turned, how it gives.

include!(concat!(env!("OUT_DIR"), "/runner.rs"));
