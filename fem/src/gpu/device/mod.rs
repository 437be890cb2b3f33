//! A graphics processor opened, its memory, and the kernels handed to it.

mod memory;
pub mod open;
pub mod work;
