//! The track's shape, and what happens at one place of it.

include!(concat!(env!("OUT_DIR"), "/track.rs"));
