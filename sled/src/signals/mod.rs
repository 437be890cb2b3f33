//! From what sensors recorded to the motion of the sled.

pub(crate) mod derivative;
pub(crate) mod distance;
pub(crate) mod filter;
pub(crate) mod further;
pub(crate) mod noise;
pub(crate) mod prepare;
pub(crate) mod resampling;
pub(crate) mod sensed;
