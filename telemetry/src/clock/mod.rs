//! Clocks of loggers brought together by what their channels share.

mod align;
mod delay;
mod pair;
mod refine;
mod search;
mod series;
mod signal;

pub use align::{Aligned, align};
pub use series::{LoggerSeries, Relation, Series};
