//! What is asked: runner, ice, track and load, checked before anything is solved, and the undeformed gap between them.

pub(crate) mod check;
pub(crate) mod contact_problem;
pub(crate) mod gap;
pub(crate) mod ice;
pub(crate) mod ice_properties;
pub(crate) mod load;
pub(crate) mod mount;
pub(crate) mod runner;
pub(crate) mod runner_solid;
