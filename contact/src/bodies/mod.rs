//! Elastic bodies: the ice and the runner.

pub(crate) mod elastic_body;
pub(crate) mod far_field;
pub(crate) mod runner_body;
pub(crate) mod solid_body;
