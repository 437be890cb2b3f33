//! Longitudinal friction over pressure: the law, its fit to experiments and its picture.

mod fit;
pub mod law;
mod mu_fit;
mod orthogonal_distance;

pub use fit::fit_mu;
pub use mu_fit::{LeastFriction, MuFit, Weighting};
