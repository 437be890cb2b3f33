//! The unloaded ice: wavy, or measured as a height map.

pub(crate) mod height_map_file;
pub(crate) mod surface;

pub use height_map_file::{ExrImage, load_height_map};
pub use surface::{HeightMap, IceSurface, Waviness};
