//! Constants of the sled that are others than stated.

include!(concat!(env!("OUT_DIR"), "/sled.rs"));
