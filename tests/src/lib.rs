//! Reference solutions and problems of the verification suite.

pub mod contact;
pub mod coverage;
pub mod exact_response;
pub mod fem;
pub mod meshes;
pub mod rigid_plastic;
pub mod under_peak;
