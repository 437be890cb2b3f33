//! Files and pictures of a solved contact: the pressure map, the groove, and the fields in the
//! bodies.

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
