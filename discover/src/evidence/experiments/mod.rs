//! Friction experiments: mu over pressure or of the melt film, one row per specimen or condition.

pub(crate) mod base;
pub(crate) mod candidates;
pub(crate) mod compare;
pub(crate) mod evidence;
pub(crate) mod fit;
pub(crate) mod known;
pub(crate) mod outcome;
pub(crate) mod pictures;
pub(crate) mod rows;
pub(crate) mod screen;
pub(crate) mod shared_effects;

pub use evidence::search;
