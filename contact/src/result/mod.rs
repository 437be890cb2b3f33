//! Pressures and figures from nodal forces, and the solution of a solve.

pub(crate) mod asperity;
pub(crate) mod centre_line;
pub(crate) mod measure;
pub(crate) mod pressure;
pub(crate) mod rim;
pub(crate) mod runner_loads;
pub(crate) mod solution;
