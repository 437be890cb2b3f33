//! Friction experiments: mu over pressure, one row a specimen or condition.

pub(crate) mod bins;
pub(crate) mod candidates;
pub(crate) mod fit;
pub(crate) mod pictures;
pub(crate) mod rows;
pub(crate) mod screen;
pub(crate) mod search;

pub use search::search;
