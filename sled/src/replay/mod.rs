//! A measured run driven again by the model, from its steering and its start.

pub(crate) mod compared;
pub(crate) mod drive;
pub(crate) mod inputs;
