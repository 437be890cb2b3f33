//! What a search over runs ends with: gaps, bins, intervals and the next model.

pub(crate) mod backward;
pub(crate) mod by_run;
pub(crate) mod finish;
pub(crate) mod gap;
pub(crate) mod next_model;
