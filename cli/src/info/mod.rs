//! `kufe info`: what a file holds.

mod command;
mod exr_file;
mod hull_file;
mod lut_file;

pub use command::{Args, run};
