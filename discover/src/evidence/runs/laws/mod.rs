//! Laws outside the catalogue: a smooth dependence on recorded columns, and the simplest formula that does as well.

pub(crate) mod fitted_law;
pub(crate) mod formulas;
pub(crate) mod judged;
pub(crate) mod selection;
pub(crate) mod smooth;
pub(crate) mod sums;
pub(crate) mod term;
pub(crate) mod terms;
