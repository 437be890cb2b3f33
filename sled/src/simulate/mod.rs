//! Driving a track, and what the sensors of the sled record of it.

pub(crate) mod drive;
pub(crate) mod driver;
pub(crate) mod dynamics;
pub mod sample_data;
pub(crate) mod sensors;
