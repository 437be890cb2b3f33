//! Laws outside the catalogue: smooth functions of columns, and the simplest equivalent formula.

pub(crate) mod fitted_law;
pub(crate) mod formula;
pub(crate) mod group_tests;
pub(crate) mod selection;
pub(crate) mod shape;
pub(crate) mod smooth_laws;
pub(crate) mod sums;
pub(crate) mod term;
pub(crate) mod terms;
