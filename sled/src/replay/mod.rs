//! A measured run driven again by the model, from its steering and its start.

pub(crate) mod again;
pub(crate) mod beside;
pub(crate) mod compared;
pub(crate) mod inputs;
pub(crate) mod sections;
