//! Loads, solvers and closed forms for the verification of the finite elements.

pub mod cg;
pub mod closed_form;
pub mod loads;
pub mod mapped;
pub mod statics;
