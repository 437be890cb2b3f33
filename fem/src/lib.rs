//! Linear elasticity on hexahedra.

// Formulas read as they are written on paper, with indices.
#![allow(clippy::needless_range_loop)]

pub mod cg;
pub mod hex8;
pub mod hex8_incompatible;

mod assembly;
mod beam;
mod beam_modes;
mod block_matrix;
mod body;
mod boussinesq;
mod cholesky;
mod constraints;
mod dissection;
mod error;
mod face;
mod fast_diagonal;
mod hex8_lanes;
mod lanes;
mod mapped_preconditioner;
mod material;
mod matrix_free;
mod node_graph;
mod section;
mod statics;
mod stress;
mod stress_measures;
mod tensor_axis;
mod tensor_operator;
mod thick_cylinder;

pub use assembly::{assemble, assemble_on};
pub use beam::Beam;
pub use beam_modes::BeamModes;
pub use block_matrix::BlockMatrix;
pub use body::Body;
pub use boussinesq::{boussinesq, boussinesq_stress, love_rectangle};
pub use cholesky::Factor;
pub use constraints::{Constraints, DofMap};
pub use dissection::nested_dissection;
pub use error::Error;
pub use face::{FACES, add_pressure, add_traction, boundary_faces};
pub use fast_diagonal::FastDiagonal;
pub use mapped_preconditioner::MappedPreconditioner;
pub use material::Material;
pub use matrix_free::MatrixFree;
pub use node_graph::NodeGraph;
pub use section::{ElementKind, Section};
pub use statics::{Equilibrium, Solver, add_body_force, equilibrium};
pub use stress::{
    extrapolate_to_corners, gauss_point_stresses, nodal_stresses, strain_at, stress_at,
};
pub use stress_measures::{maximum_shear, principal_stresses, von_mises};
pub use tensor_axis::{Axis, AxisModes, Tridiagonal};
pub use tensor_operator::{HeldFaces, TensorOperator};
pub use thick_cylinder::ThickCylinder;
