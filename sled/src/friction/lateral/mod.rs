//! Lateral force over slip and load: the laws, and the fit of one to samples with noise in the slip.

pub mod fit;
mod identifiability;
pub mod law;
mod least_squares;
pub mod nearby;
mod options;
mod root;
mod score;

pub use identifiability::{Combination, Identifiability};
pub use options::LateralFitOptions;
pub use score::LateralSample;
