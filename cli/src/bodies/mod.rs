//! Runner and ice as bodies in files: hulls, hexahedra, and problems for other solvers.

pub mod export;
pub mod hull;
pub mod mesh;
