//! How well a model explains runs, and how well runs were driven.

pub(crate) mod driving;
pub(crate) mod groups;
pub(crate) mod track_loss;
pub(crate) mod validate;
