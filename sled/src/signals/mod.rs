//! From what sensors recorded to the motion of the sled.

pub(crate) mod filtered;
pub(crate) mod prepare;
