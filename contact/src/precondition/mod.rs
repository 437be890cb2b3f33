//! Approximate inverses of the stiffness of bodies on tensor grids, and exact ones of small
//! systems.

pub(crate) mod dense;
pub(crate) mod factored;
pub(crate) mod mounted;
pub(crate) mod planewise;
