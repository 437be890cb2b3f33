//! The pressure map: the fields of a solved contact on a regular grid of pixels.

pub(crate) mod pressure_map;
pub(crate) mod rim;
