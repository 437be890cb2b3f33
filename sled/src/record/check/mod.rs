//! Whether a run's columns are what their names say, and which samples take part.

pub(crate) mod clock;
pub(crate) mod columns;
pub(crate) mod examine;
pub(crate) mod gaps;
pub(crate) mod needs;
pub(crate) mod profile;
pub(crate) mod relations;
pub(crate) mod saturation;
pub(crate) mod taking_part;

pub use clock::Clock;
pub use columns::{LEAST_SAMPLES, check_columns};
pub use gaps::{Gaps, LEAST_SPEED, OnGaps};
pub use taking_part::{TakingPart, gaps_line};
