//! Verification suite.

pub mod meshes;
