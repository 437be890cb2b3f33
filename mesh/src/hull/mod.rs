//! Hulls as triangles: read, written, made from runners, and checked.

pub(crate) mod file;
pub(crate) mod read_3mf;
pub(crate) mod read_gltf;
pub(crate) mod read_obj;
pub(crate) mod read_stl;
pub(crate) mod tessellate;
pub(crate) mod text;
pub(crate) mod triangles;
pub(crate) mod write;

pub use file::{HullFormat, hull_files, load_hull};
pub use read_3mf::read_3mf;
pub use read_gltf::read_gltf;
pub use read_obj::read_obj;
pub use read_stl::read_stl;
pub use tessellate::{tessellate, tessellate_steel};
pub use triangles::{
    Axis, Hull, HullOptions, HullReport, check_hull, checked_runner, size_warnings,
};
