//! From what sensors recorded to the motion of the sled.

pub(crate) mod prepare;
pub(crate) mod sensed;
