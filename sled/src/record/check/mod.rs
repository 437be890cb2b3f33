//! Whether a run's columns are what their names say.

pub(crate) mod columns;
pub(crate) mod examine;
pub(crate) mod profile;
pub(crate) mod relations;

pub use crate::record::gaps::{Gaps, LEAST_SPEED, OnGaps, SampleCoverage, gaps_line};
pub use columns::{Clock, LEAST_SAMPLES, check_columns};
