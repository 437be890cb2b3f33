//! Pressure measurements: maps and peaks against contact solves.

pub(crate) mod bins;
pub(crate) mod evidence;
pub(crate) mod line;
pub(crate) mod next_case;
pub(crate) mod noise;
pub(crate) mod pictures;
pub(crate) mod polish;
pub(crate) mod registration;
pub(crate) mod rows;
pub(crate) mod sample;
pub(crate) mod screen;
pub(crate) mod simulate;

pub use evidence::search;
