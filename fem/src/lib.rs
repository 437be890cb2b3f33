//! Linear elasticity on hexahedra.
//!
//! | type or function | meaning |
//! |---|---|
//! | [`Material`], [`ElementKind`], [`Section`], [`Body`] | a mesh with its materials and elements, checked once |
//! | [`hex8`] | the trilinear hexahedron |
//! | [`Constraints`] | supports |
//! | [`nodal_stresses`], [`grid_stresses`], [`von_mises`] | stresses |
//! | [`assemble`], [`BlockMatrix`], [`SparseStiffness`], [`write_matrix_market`] | the stored stiffness |
//! | [`MatrixFree`], [`TensorOperator`] | the stiffness applied without being stored |
//! | [`Factor`] | Cholesky by nested dissection |
//! | [`FastDiagonal`], [`PlanewiseDiagonal`] | preconditioners on a tensor grid |
//! | [`BeamModes`] | a coarse space of slender bodies |
//! | [`boussinesq`], [`love_depth`] | closed forms |
//!
//! Vectors of a [`Body`] hold three numbers a node, node by node. Those of a [`TensorOperator`] are
//! ordered component by component.
//!
//! ```
//! use kufe_fem::{
//!     Body, Constraints, ElementKind, Factor, Material, assemble, nodal_stresses, von_mises,
//! };
//! use kufe_mesh::TensorGrid;
//!
//! // A steel bar of 10 x 10 x 100 mm, fixed at its lower end and pulled by 1 kN at its upper end.
//! let grid = TensorGrid { x: vec![0.0, 0.01], y: vec![0.0, 0.01], z: vec![0.0, 0.05, 0.1] };
//! let body = Body::uniform(grid.hex_mesh(), Material::new(210e9, 0.3)?, ElementKind::Hex8)?;
//! let mut constraints = Constraints::new(body.node_count());
//! constraints.symmetry([0, 1, 2, 3], 2)?;
//! constraints.symmetry([0, 2], 0)?;
//! constraints.prescribe(0, 1, 0.0)?;
//! let mut loads = vec![0.0; body.dofs()];
//! (8..12).for_each(|node| loads[3 * node + 2] = 250.0);
//! let (stiffness, map) = (assemble(&body), constraints.dof_map());
//! let factor = Factor::of_body(&stiffness, &map, &body.mesh().points)?;
//! let displacement = factor.displacement(&stiffness, &constraints, &map, &loads);
//! let stress = nodal_stresses(&body, &displacement);
//! assert!((von_mises(stress[5]) / 10.0e6 - 1.0).abs() < 1e-9);
//! # Ok::<(), kufe_fem::Error>(())
//! ```

// Formulas are written with indices, as on paper.
#![allow(clippy::needless_range_loop)]

mod body;
mod closed_form;
mod constraints;
mod element;
mod error;
mod matrix_free;
mod precondition;
mod sparse;
mod stress;
mod tensor;

pub use body::{Body, ElementKind, Material, Section};
pub use closed_form::{boussinesq, love_depth};
pub use constraints::{Constraints, DofMap, to_components, to_nodes};
pub use element::face::{FACES, boundary_faces};
pub use element::hex8;
pub use error::Error;
pub use matrix_free::operator::MatrixFree;
pub use precondition::beam_modes::BeamModes;
pub use precondition::elimination::End;
pub use precondition::fast_diagonal::FastDiagonal;
pub use precondition::planewise_diagonal::PlanewiseDiagonal;
pub use sparse::assembly::{BlockMatrix, assemble, write_matrix_market};
pub use sparse::cholesky::Factor;
pub use sparse::graph::NodeCells;
pub use sparse::stiffness::SparseStiffness;
pub use stress::{grid_stresses, maximum_shear, nodal_stresses, strain_at, stress_at, von_mises};
pub use tensor::axis::{Axis, AxisModes, Tridiagonal};
pub use tensor::operator::{FixedFaces, LowerLayer, TensorOperator};
