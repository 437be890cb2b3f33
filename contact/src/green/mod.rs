//! The displacements that contact forces make on the contact plane.

pub(crate) mod closed_set;
pub(crate) mod matrix;
pub(crate) mod modal;
