//! The contact iteration on one mesh: which nodes touch, and the equations on that set.

pub(crate) mod balance;
pub(crate) mod constrained_cg;
pub(crate) mod contact_set;
pub(crate) mod plane_problem;
