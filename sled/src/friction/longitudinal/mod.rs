//! Longitudinal friction over pressure: the law, its fit to experiments and its picture.

mod fit;
pub mod law;

pub use fit::{LeastFriction, MuFit, Weighting, fit_mu};
