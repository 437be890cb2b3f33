//! How well a model explains runs, and how well runs were driven.

pub(crate) mod bootstrap;
pub(crate) mod driving;
pub(crate) mod groups;
pub(crate) mod residuals;
pub(crate) mod validate;
