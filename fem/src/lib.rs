//! Linear elasticity on hexahedra.

// Formulas read as they are written on paper, with indices.
#![allow(clippy::needless_range_loop)]

pub mod cg;
pub mod hex8;
pub mod hex8_incompatible;

mod assembly;
mod block_matrix;
mod body;
mod boussinesq;
mod cholesky;
mod constraints;
mod dissection;
mod error;
mod face;
mod material;
mod node_graph;
mod section;
mod statics;

pub use boussinesq::{boussinesq, boussinesq_stress, love_rectangle};
pub use error::Error;
pub use material::Material;
pub use assembly::{assemble, assemble_on};
pub use block_matrix::BlockMatrix;
pub use body::Body;
pub use cholesky::Factor;
pub use constraints::{Constraints, DofMap};
pub use dissection::nested_dissection;
pub use face::{FACES, add_pressure, add_traction, boundary_faces};
pub use node_graph::NodeGraph;
pub use section::{ElementKind, Section};
pub use statics::{Equilibrium, Solver, add_body_force, equilibrium};
