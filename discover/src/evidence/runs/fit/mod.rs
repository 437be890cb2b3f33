//! Base and effects fitted together, with what noisy inputs add taken off.

mod balance_products;
pub(crate) mod estimate;
mod few_runs;
pub(crate) mod gauss_newton;
mod installed;
pub(crate) mod noise_products;
pub(crate) mod piece;
pub(crate) mod refit;
pub(crate) mod refits;
pub(crate) mod row_noise;
pub(crate) mod simulated_runs;
