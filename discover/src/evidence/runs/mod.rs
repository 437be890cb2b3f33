//! Runs: what is measured on a track, against the one-track model.

pub(crate) mod candidates;
pub(crate) mod fit;
pub(crate) mod model;
pub(crate) mod outcome;
pub(crate) mod recordings;
pub(crate) mod screen;
pub(crate) mod search;
pub(crate) mod searcher;

pub use recordings::prepare::{Data, prepare};
pub use recordings::read::read;
pub use search::{Found, search};
