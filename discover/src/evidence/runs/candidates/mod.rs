//! What could be missing from the model of a sled.

pub(crate) mod amplitude;
pub(crate) mod catalogue;
pub(crate) mod columns;
