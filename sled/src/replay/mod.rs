//! Replay: simulation of a measured run from its steering and its start.

pub(crate) mod compared;
pub(crate) mod drive;
pub(crate) mod inputs;
