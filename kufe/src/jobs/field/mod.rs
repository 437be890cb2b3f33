//! A solved contact's fields as files and pictures: the map of the pressure, the groove, what is in the bodies.

pub mod compared_maps;
pub mod contact_vtp;
mod files;
pub mod groove_map;
pub mod groove_picture;
#[cfg(test)]
mod hertz_map;
pub mod map_picture;
mod placed_hull;
pub mod read_exr;
pub mod stress_picture;
pub mod subsurface;
pub mod volume_vtu;
pub mod write_exr;

pub use files::{NewFiles, is_plain, pretty, write_contact};
pub use placed_hull::placed_hull;
