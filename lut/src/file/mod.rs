//! `.lut` files (docs/tables.md): written, and read with every number checked.

pub(crate) mod format;
pub(crate) mod json;
pub(crate) mod read;
pub(crate) mod write;

pub use read::MAX_FILE_BYTES;
