//! Validation of a model by runs, and evaluation of drivers.

pub(crate) mod driving;
pub(crate) mod groups;
pub(crate) mod track_loss;
pub(crate) mod validate;
