//! How an iteration goes, and when it ends.

use crate::Options;

/// How an iteration went.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    /// Conjugate-gradient iterations in all.
    pub iterations: usize,
    /// For each contact set: nodes, iterations, residual, largest force.
    pub updates: Vec<SetUpdate>,
    /// Energy-norm residual over the energy of the solution.
    pub residual: f64,
    /// Whether tolerance and set were both reached.
    pub converged: bool,
}

impl Progress {
    /// A solve without iterations.
    pub fn direct(converged: bool) -> Self {
        Progress {
            iterations: 0,
            updates: Vec::new(),
            residual: 0.0,
            converged,
        }
    }
}

/// When an iteration ends, converged or not.
pub(crate) struct Limit<'a> {
    /// Most iterations.
    pub iterations: usize,
    /// Who may stop it.
    pub options: &'a Options,
}

impl Limit<'_> {
    /// Whether it is to end after so many iterations.
    pub fn reached(&self, iterations: usize) -> bool {
        iterations >= self.iterations || self.options.stopped()
    }
}

/// What happened with one contact set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetUpdate {
    pub contact_nodes: usize,
    pub iterations: usize,
    pub residual: f64,
}
