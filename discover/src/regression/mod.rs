//! Least squares over runs: products of columns, scores given a base, inverses.

pub(crate) mod gram;
pub(crate) mod inverse;
pub(crate) mod prior;
pub(crate) mod scores;

pub use gram::Gram;
pub use prior::Prior;
pub use scores::Scores;
