//! Candidate effects on a sled.

pub(crate) mod amplitude;
pub(crate) mod catalogue;
pub(crate) mod columns;
