//! Runs on a track, compared with the one-track model.

pub(crate) mod campaign;
pub(crate) mod candidates;
pub(crate) mod channels;
pub(crate) mod contacts;
pub(crate) mod evidence;
pub(crate) mod fit;
pub(crate) mod laws;
pub(crate) mod model;
pub(crate) mod outcome;
pub(crate) mod recordings;
pub(crate) mod screen;
pub(crate) mod shared_effects;

pub use evidence::search;
pub use recordings::prepare::{Data, prepare};
pub use recordings::read::read;
