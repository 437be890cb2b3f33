//! Formulas of laws: shapes, the set that is tried, and the selection among them.

pub(crate) mod formula;
pub(crate) mod shape;
pub(crate) mod shapes;
