//! The track that a sled drives on: its table, and smooth curves through it.

pub(crate) mod spline;
pub(crate) mod table;
