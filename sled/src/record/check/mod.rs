//! Checks of a run's columns against their names: column by column, and by the relations of a rigid
//! body between them.

pub(crate) mod columns;
mod corrections;
pub(crate) mod examine;
pub(crate) mod faults;
pub(crate) mod profile;
mod relations;
mod response;
mod rotation;
mod single;

pub use crate::record::gaps::{Gaps, LEAST_SPEED, OnGaps, SampleCoverage, gaps_line};
pub use columns::{Clock, MIN_RUN_SAMPLES, check_columns};
