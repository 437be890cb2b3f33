//! What the verification of the finite elements needs in addition to them.

pub mod cg;
pub mod closed_form;
pub mod loads;
pub mod mapped;
pub mod statics;
