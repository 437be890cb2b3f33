//! Filling a table: given points, or points placed until the interpolation is as good as asked.

pub(crate) mod batches;
pub(crate) mod each;
pub(crate) mod grid;
pub(crate) mod halve;
pub(crate) mod known;
pub(crate) mod misses;
pub(crate) mod plan;
pub(crate) mod refine;

pub use batches::{SweepError, Swept, sweep, sweep_batches};
pub use each::each;
pub use plan::{Plan, Spacing};
