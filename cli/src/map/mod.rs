//! The pressure map: a contact's fields on a grid of pixels, written, read back and drawn.

pub mod draw;
mod hermite;
#[cfg(test)]
mod hertz_field;
mod outline;
pub mod patches;
pub mod pressure_map;
pub mod read_exr;
mod rim;
pub mod write_exr;
