//! Formulas of laws: how each depends on its columns, which are tried, and the simplest that does as well as the best.

pub(crate) mod formula;
pub(crate) mod shape;
pub(crate) mod shapes;
