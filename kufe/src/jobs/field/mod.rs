//! A solved contact's fields as files and pictures: the map of the pressure, the groove, what is in
//! the bodies.

mod exr;
mod files;
mod groove;
mod maps;
mod placed_hull;
mod stress_picture;
mod subsurface;
#[cfg(test)]
mod tests;
mod vtk;

pub use exr::read_map;
pub use files::{NewFiles, is_plain, pretty, write_contact};
pub use maps::ComparedMaps;
pub use placed_hull::placed_hull;
