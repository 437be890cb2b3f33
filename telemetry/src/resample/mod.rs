//! Samples at any times brought to one base of times, with nothing invented across gaps.

mod base;
mod stretch;

pub use base::{Base, Gap, Resampled, resample};
pub(crate) use stretch::stretches;
