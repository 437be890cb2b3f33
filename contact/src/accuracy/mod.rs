//! Finer and finer meshes, until the pressure is as exact as was asked.

pub(crate) mod extrapolation;
#[cfg(test)]
mod highest_tests;
pub(crate) mod judge;
pub(crate) mod mesh_solve;
pub(crate) mod meshes;
#[cfg(test)]
pub(crate) mod one_mesh;
pub(crate) mod order;
pub(crate) mod own_cells;
#[cfg(test)]
mod rejection_tests;
pub(crate) mod scout;
pub(crate) mod under_peak;
pub(crate) mod watched;
