//! How accurate a solve is to be, and what it may cost.

use std::sync::Arc;

use crate::Iterate;

/// Accuracy and limits of a solve.
#[derive(Clone)]
pub struct Options {
    /// Relative discretisation error asked of the peak pressure.
    pub p_max_tolerance: f64,
    /// Relative energy-norm residual of the equations on each mesh.
    pub residual: f64,
    /// Largest number of unknowns of a mesh.
    pub max_dofs: usize,
    /// Called after every update of the contact set.
    pub progress: Option<Arc<dyn Fn(&Iterate) + Send + Sync>>,
}

impl Default for Options {
    /// One per cent of peak pressure, residual 1e-9, at most 4 million unknowns, silent.
    fn default() -> Self {
        Options {
            p_max_tolerance: 0.01,
            residual: 1e-9,
            max_dofs: 4_000_000,
            progress: None,
        }
    }
}
