//! Cheap inverses of a body's stiffness, ready for a constraint on the contact plane.

pub(crate) mod beam_space;
pub(crate) mod clamps;
pub(crate) mod dense_cholesky;
pub(crate) mod dense_lu;
pub(crate) mod factored;
pub(crate) mod inverse;
pub(crate) mod mounted;
pub(crate) mod plane_basis;
pub(crate) mod plane_modes;
pub(crate) mod planewise;
pub(crate) mod response;
pub(crate) mod work;
