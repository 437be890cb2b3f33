//! Units as loggers write them, converted to those of kufe's columns.

mod column;
mod convert;

pub use column::column_unit;
pub(crate) use convert::is_unit;
pub use convert::{Conversion, conversion};
