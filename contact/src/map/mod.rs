//! The pressure map: a solved contact's fields on a regular grid of pixels, its rim finer than a cell.

mod hermite;
#[cfg(test)]
mod hertz_field;
pub mod patches;
pub mod pressure_map;
pub mod rim;
