//! `kufe info`: what a file holds.

mod columns_file;
mod command;
mod exr_file;
mod hull_file;
mod json_file;
mod lut_file;
mod marked_file;
mod mat_file;
mod png_file;
mod toml_file;
mod vtk_file;

pub use command::{Args, run};
