//! Runs: what is measured on a track, against the one-track model.

pub(crate) mod analysis;
pub(crate) mod by_run;
pub(crate) mod candidates;
pub(crate) mod chain;
pub(crate) mod corrected;
pub(crate) mod data;
pub(crate) mod design;
pub(crate) mod estimate;
pub(crate) mod fit;
pub(crate) mod gap;
pub(crate) mod levels;
pub(crate) mod lock;
pub(crate) mod next;
pub(crate) mod search;
pub(crate) mod track;
pub(crate) mod twins;
pub(crate) mod whiten;

pub use data::{Data, prepare, read};
pub use search::{Found, search};
