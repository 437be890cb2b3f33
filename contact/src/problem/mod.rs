//! The contact problem: runner, ice, track and load, their ranges, and the undeformed gap.

pub(crate) mod check;
pub(crate) mod contact_problem;
pub(crate) mod gap;
pub(crate) mod ice;
pub(crate) mod mount;
pub(crate) mod runner_solid;
