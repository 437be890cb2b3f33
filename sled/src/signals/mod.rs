//! From recorded sensors to the motion of the sled.

pub(crate) mod filtered;
pub(crate) mod prepare;
