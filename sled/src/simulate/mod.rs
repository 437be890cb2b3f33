//! Simulation of a sled on a track, and of the recording of its sensors.

pub(crate) mod drive;
pub(crate) mod driver;
pub(crate) mod dynamics;
pub mod sample_data;
pub(crate) mod sensors;
