//! Finer and finer meshes, until the pressure has the requested accuracy.

pub(crate) mod answer;
pub(crate) mod estimators;
pub(crate) mod find_patch;
pub(crate) mod mesh_solve;
pub(crate) mod meshes;
pub(crate) mod own_cells;
pub(crate) mod penetration_check;
pub(crate) mod watched;
