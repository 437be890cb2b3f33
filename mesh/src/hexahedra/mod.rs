//! Meshes of hexahedra: made, judged, read and written.

pub(crate) mod filled;
pub(crate) mod from_elsewhere;
pub(crate) mod hex_mesh;
pub(crate) mod mapped_mesh;
pub(crate) mod quality;
pub(crate) mod read_gmsh;
pub(crate) mod slope_limit;
pub(crate) mod tensor_grid;
pub(crate) mod vtu;

pub use filled::Filled;
pub use hex_mesh::HexMesh;
pub use mapped_mesh::{graded_levels, mapped_runner_mesh, mesh_over_heights};
pub use quality::Quality;
pub use read_gmsh::read_gmsh;
pub use slope_limit::limit_slope;
pub use tensor_grid::TensorGrid;
pub use vtu::{VtuField, read_vtu, write_pvd, write_vtp, write_vtu};
