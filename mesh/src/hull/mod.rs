//! Hulls as triangles: read, written, made from runners, and checked.

pub(crate) mod axes;
pub(crate) mod check;
pub(crate) mod file;
pub(crate) mod read_gltf;
pub(crate) mod read_obj;
pub(crate) mod read_stl;
pub(crate) mod tessellate;
pub(crate) mod triangles;
pub(crate) mod write;

pub use axes::{Axis, HullOptions};
pub use check::{HullReport, HullWarning, check_hull, size_warnings};
pub use file::{HullFormat, hull_files, load_hull};
pub use read_gltf::read_gltf;
pub use read_obj::read_obj;
pub use read_stl::read_stl;
pub use tessellate::{tessellate, tessellate_turning};
pub use triangles::Hull;
pub use write::{write_glb, write_obj, write_stl};
