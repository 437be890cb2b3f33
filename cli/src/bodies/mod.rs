//! Commands on bodies: hulls, hexahedral meshes, and export for other solvers.

pub mod export;
pub mod hull;
pub mod mesh;
