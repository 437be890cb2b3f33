//! Readers of tables and pressure maps.

pub(crate) mod exr_map;
pub(crate) mod table;

pub use exr_map::{read_map, read_map_bytes};
