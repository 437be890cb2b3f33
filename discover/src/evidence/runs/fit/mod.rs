//! Joint fit of base and effects, corrected for noisy inputs.

pub(crate) mod estimate;
pub(crate) mod gauss_newton;
mod installed;
pub(crate) mod misfit;
pub(crate) mod noise_products;
pub(crate) mod piece;
pub(crate) mod row_noise;
pub(crate) mod simulated_runs;
