//! VTU files, series of them as PVD files, and surfaces as VTP files.

pub(crate) mod data;
pub(crate) mod file;
pub(crate) mod pvd;
pub(crate) mod read;
pub(crate) mod write;
pub(crate) mod write_vtp;

pub use pvd::write_pvd;
pub use read::read_vtu;
pub use write::{VtuField, write_vtu};
pub use write_vtp::write_vtp;
