//! Hulls, their smooth undersides, and hexahedral grids.
//!
//! | type | what it is |
//! |---|---|
//! | [`Underside`] | the height of a hull's lower surface over the contact plane |
//! | [`Swept`] | a [`Section`] swept along a [`Rocker`]: [`BobRunner`] and [`LugeSteel`] make one |
//! | [`Paraboloid`] | an unbounded paraboloid, for verification |
//! | [`TensorGrid`] | graded coordinates along x, y and z |
//! | [`HexMesh`] | points and eight-node hexahedra |
//!
//! ```
//! use kufe_mesh::TensorGrid;
//! let grid = TensorGrid { x: vec![0.0, 1.0, 3.0], y: vec![0.0, 1.0], z: vec![-1.0, 0.0] };
//! let mesh = grid.hex_mesh();
//! assert_eq!((mesh.points.len(), mesh.cells.len()), (12, 2));
//! ```

mod bob_runner;
mod error;
mod hex_mesh;
mod luge_steel;
mod paraboloid;
mod profile;
mod rocker;
mod section;
mod swept;
mod tensor_grid;
mod underside;

pub use bob_runner::BobRunner;
pub use error::MeshError;
pub use hex_mesh::HexMesh;
pub use luge_steel::LugeSteel;
pub use paraboloid::Paraboloid;
pub use profile::Profile;
pub use rocker::Rocker;
pub use section::Section;
pub use swept::{Ends, Swept};
pub use tensor_grid::TensorGrid;
pub use underside::Underside;
