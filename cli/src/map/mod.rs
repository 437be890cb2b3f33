//! The pressure map as a file and as a picture.

pub mod draw;
pub mod groove;
#[cfg(test)]
mod hertz_map;
mod outline;
pub mod read_exr;
pub mod write_exr;
