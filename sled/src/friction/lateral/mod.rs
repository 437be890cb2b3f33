//! Lateral force over slip and load: the laws, and the fit of one to samples with noise in the
//! slip.

pub mod fit;
pub mod law;

pub use fit::{Combination, LateralFitOptions, LateralSample};
