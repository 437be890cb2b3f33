//! The ice: how stiff, how hard, how thick, how smooth.

include!(concat!(env!("OUT_DIR"), "/ice.rs"));
