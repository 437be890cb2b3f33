//! Runner and ice as bodies in files: hulls, hexahedra, and problems for other solvers.

mod calculix;
pub mod export;
pub mod hull;
pub mod mesh;
mod scan;
pub mod stiffness;
