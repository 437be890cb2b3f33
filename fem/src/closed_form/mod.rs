//! Solutions on paper that the elements are tested against.

pub mod beam;
pub mod boussinesq;
pub mod thick_cylinder;
