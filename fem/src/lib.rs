//! Linear elasticity on hexahedra.
//!
//! | type or function | what it is |
//! |---|---|
//! | [`Material`], [`Section`], [`Body`] | what a mesh is made of, checked once |
//! | [`hex8`], [`hex8_incompatible`], [`hex8_axial`] | the trilinear hexahedron, and two that bend without locking |
//! | [`hex8_dilatation`] | the one for nearly incompressible materials |
//! | [`Constraints`], [`add_pressure`], [`add_traction`], [`add_body_force`] | supports and loads |
//! | [`equilibrium`] | loads in, displacements and reactions out |
//! | [`nodal_stresses`], [`grid_stresses`], [`gauss_point_stresses`], [`von_mises`] | stresses |
//! | [`assemble`], [`BlockMatrix`], [`MatrixFree`] | the stiffness, stored and not |
//! | [`SparseStiffness`], [`write_matrix_market`] | the stored one as faer's sparse matrix, by component, and as text |
//! | [`Factor`], [`cg`] | Cholesky by nested dissection, conjugate gradients |
//! | [`TensorOperator`], [`PlanewiseDiagonal`] | stiffness and preconditioner on a tensor grid ([`FastDiagonal`]: the plain one) |
//! | [`MappedPreconditioner`], [`BeamModes`] | the same for bent grids and slender bodies |
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

mod body;
mod closed_form;
mod constraints;
mod element;
mod error;
mod layout;
mod material;
mod matrix_free;
mod precondition;
mod section;
mod sparse;
mod statics;
mod stress;
mod tensor;
#[cfg(test)]
mod test_block;

pub use body::Body;
pub use closed_form::beam::Beam;
pub use closed_form::boussinesq::{boussinesq, boussinesq_stress, love_depth, love_rectangle};
pub use closed_form::thick_cylinder::ThickCylinder;
pub use constraints::{Constraints, DofMap};
pub use element::face::{FACES, add_pressure, add_traction, boundary_faces};
pub use element::{hex8, hex8_axial, hex8_dilatation, hex8_incompatible};
pub use error::Error;
pub use layout::{to_components, to_nodes};
pub use material::Material;
pub use matrix_free::operator::MatrixFree;
pub use precondition::beam_modes::BeamModes;
pub use precondition::elimination::End;
pub use precondition::fast_diagonal::FastDiagonal;
pub use precondition::mapped::MappedPreconditioner;
pub use precondition::planewise_diagonal::PlanewiseDiagonal;
pub use section::{ElementKind, Section};
pub use sparse::assembly::{assemble, assemble_on};
pub use sparse::block_matrix::BlockMatrix;
pub use sparse::cholesky::Factor;
pub use sparse::dissection::nested_dissection;
pub use sparse::matrix_market::write_matrix_market;
pub use sparse::node_cells::NodeCells;
pub use sparse::node_graph::NodeGraph;
pub use sparse::stiffness::SparseStiffness;
pub use statics::{Equilibrium, Solver, add_body_force, equilibrium};
pub use stress::field::{
    extrapolate_to_corners, gauss_point_stresses, nodal_stresses, strain_at, stress_at,
};
pub use stress::measures::{maximum_shear, principal_stresses, von_mises};
pub use stress::on_grid::grid_stresses;
pub use tensor::axis::{Axis, AxisModes, Tridiagonal};
pub use tensor::operator::{HeldFaces, LowerLayer, TensorOperator};
