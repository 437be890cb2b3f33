//! Linear elasticity on hexahedra.
//!
//! | type or function | what it is |
//! |---|---|
//! | [`Material`], [`Section`], [`Body`] | what a mesh is made of, checked once |
//! | [`hex8`], [`hex8_incompatible`], [`hex8_axial`] | the trilinear hexahedron, and two that bend without locking |
//! | [`Constraints`], [`add_pressure`], [`add_traction`], [`add_body_force`] | supports and loads |
//! | [`equilibrium`] | loads in, displacements and reactions out |
//! | [`nodal_stresses`], [`gauss_point_stresses`], [`von_mises`] | stresses |
//! | [`assemble`], [`BlockMatrix`], [`MatrixFree`] | the stiffness, stored and not |
//! | [`Factor`], [`cg`] | Cholesky by nested dissection, conjugate gradients |
//! | [`TensorOperator`], [`LayeredDiagonal`] | stiffness and preconditioner on a tensor grid ([`FastDiagonal`]: the plain one) |
//! | [`MappedPreconditioner`], [`BeamModes`] | the same for bent grids and slender bodies |
//! | `gpu`, with the feature of that name | the kernels of tensor grids and conjugate gradients on a graphics processor |
//! | [`boussinesq`], [`love_rectangle`], [`ThickCylinder`], [`Beam`] | closed forms |
//!
//! Vectors of a [`Body`] hold three numbers a node, node by node; those of a [`TensorOperator`] component by component.
//!
//! ```
//! use kufe_fem::{Body, Constraints, ElementKind, Material, Solver, equilibrium, nodal_stresses, von_mises};
//! use kufe_mesh::TensorGrid;
//!
//! // A steel bar of 10 x 10 x 100 mm, held at its lower end and pulled by 1 kN at the upper.
//! let grid = TensorGrid { x: vec![0.0, 0.01], y: vec![0.0, 0.01], z: vec![0.0, 0.05, 0.1] };
//! let body = Body::uniform(grid.hex_mesh(), Material::new(210e9, 0.3)?, ElementKind::Hex8)?;
//! let mut constraints = Constraints::new(body.node_count());
//! constraints.symmetry([0, 1, 2, 3], 2)?;
//! constraints.symmetry([0, 2], 0)?;
//! constraints.prescribe(0, 1, 0.0)?;
//! let mut loads = vec![0.0; body.dofs()];
//! (8..12).for_each(|node| loads[3 * node + 2] = 250.0);
//! let state = equilibrium(&body, &constraints, &loads, Solver::Cholesky)?;
//! let stress = nodal_stresses(&body, &state.displacement);
//! assert!((von_mises(stress[5]) / 10.0e6 - 1.0).abs() < 1e-9);
//! # Ok::<(), kufe_fem::Error>(())
//! ```

// Formulas read as they are written on paper, with indices.
#![allow(clippy::needless_range_loop)]

pub mod cg;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod hex8;
pub mod hex8_axial;
pub mod hex8_incompatible;

mod assembly;
mod beam;
mod beam_modes;
mod block_matrix;
mod body;
mod boussinesq;
mod cholesky;
mod constraints;
mod dense;
mod dissection;
mod elimination;
mod error;
mod face;
mod fast_diagonal;
mod hex8_lanes;
mod lanes;
mod layered_diagonal;
mod mapped_preconditioner;
mod material;
mod matrix_free;
mod node_graph;
mod plane_modes;
mod row_ends;
mod section;
mod statics;
mod stress;
mod stress_measures;
mod tensor_axis;
mod tensor_faces;
mod tensor_factors;
mod tensor_kernel;
mod tensor_operator;
mod tensor_slab;
mod tensor_stencils;
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
pub use elimination::End;
pub use error::Error;
pub use face::{FACES, add_pressure, add_traction, boundary_faces};
pub use fast_diagonal::FastDiagonal;
pub use layered_diagonal::LayeredDiagonal;
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
pub use tensor_operator::{HeldFaces, LowerLayer, TensorOperator};
pub use thick_cylinder::ThickCylinder;
