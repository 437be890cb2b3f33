//! Hexahedral meshes: construction, quality, readers and writers.

pub(crate) mod filled;
pub(crate) mod hex_mesh;
pub(crate) mod quality;
pub(crate) mod read_gmsh;
pub(crate) mod read_vtu;
pub(crate) mod write_vtk;

pub use filled::Filled;
pub use hex_mesh::{
    HexMesh, TensorGrid, graded_levels, limit_slope, mapped_runner_mesh, mesh_over_heights,
};
pub use quality::Quality;
pub use read_gmsh::read_gmsh;
pub use read_vtu::read_vtu;
pub use write_vtk::{VtuField, write_pvd, write_vtp, write_vtu};
