//! The track as a sled feels it: its table, and smooth curves through it.

pub(crate) mod align;
pub(crate) mod ice;
pub(crate) mod shape;
pub(crate) mod spline;
pub(crate) mod table;
