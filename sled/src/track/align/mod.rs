//! Runs brought to one distance along the track, and the track that they felt.

pub(crate) mod course;
pub(crate) mod estimate;
pub(crate) mod felt;
pub(crate) mod refine;
pub(crate) mod runs;
pub(crate) mod search;
pub(crate) mod warp;
