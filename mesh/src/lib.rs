//! Hulls, their smooth undersides, and hexahedral grids.
//!
//! | type | what it is |
//! |---|---|
//! | [`Underside`] | the height of a hull's lower surface over the contact plane |
//! | [`TensorGrid`] | graded coordinates along x, y and z |
//! | [`HexMesh`] | points and eight-node hexahedra |
//!
//! ```
//! use kufe_mesh::TensorGrid;
//! let grid = TensorGrid { x: vec![0.0, 1.0, 3.0], y: vec![0.0, 1.0], z: vec![-1.0, 0.0] };
//! let mesh = grid.hex_mesh();
//! assert_eq!((mesh.points.len(), mesh.cells.len()), (12, 2));
//! ```

mod hex_mesh;
mod tensor_grid;
mod underside;

pub use hex_mesh::HexMesh;
pub use tensor_grid::TensorGrid;
pub use underside::Underside;
