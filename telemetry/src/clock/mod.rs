//! Clocks of loggers brought together by what their channels share.

mod align;
mod series;

pub use align::{Aligned, align};
pub use series::{LoggerSeries, Relation, Series};
