//! The forms that other programs read: CSV, MAT, C headers, blocks for Simulink, FMUs and pictures.

pub(crate) mod csv;
pub(crate) mod fmu;
pub(crate) mod header;
pub(crate) mod mat;
pub(crate) mod mat_file;
mod mat_units;
mod sample;
pub(crate) mod simulink;

pub use fmu::{Fmu, read_fmu};
pub use mat_file::{MatValue, write_mat_file};
pub use sample::Sample;
pub use simulink::simulink_files;
