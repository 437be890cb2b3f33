//! The ice before it is loaded: wavy, or measured as a height map.

pub(crate) mod exr_image;
pub(crate) mod height_map;
pub(crate) mod height_map_csv;
pub(crate) mod height_map_file;
pub(crate) mod surface;
pub(crate) mod waviness;

pub use exr_image::ExrImage;
pub use height_map::{HeightMap, Interpolation};
pub use height_map_file::load_height_map;
pub use surface::IceSurface;
pub use waviness::Waviness;
