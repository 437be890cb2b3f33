//! The contact iteration on one mesh: which nodes touch, and the equations while they do.

pub(crate) mod balance;
pub(crate) mod constrained_cg;
pub(crate) mod contact_set;
pub(crate) mod energy;
pub(crate) mod motion;
pub(crate) mod plane_problem;
pub(crate) mod progress;
pub(crate) mod sets;
pub(crate) mod vector;
