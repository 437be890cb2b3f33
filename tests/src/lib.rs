//! Verification suite.

pub mod contact;
pub mod coverage;
pub mod meshes;
pub mod under_peak;
