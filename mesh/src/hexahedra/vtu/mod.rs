//! VTU files, and series of them as PVD files.

pub(crate) mod data;
pub(crate) mod file;
pub(crate) mod pvd;
pub(crate) mod read;
pub(crate) mod write;

pub use pvd::write_pvd;
pub use read::read_vtu;
pub use write::{VtuField, write_vtu};
