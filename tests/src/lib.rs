//! Verification suite.

pub mod contact;
pub mod meshes;
