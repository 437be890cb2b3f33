//! How an iteration goes, when it ends, and who is told.

use crate::Options;
use crate::grid::contact_mesh::State;

/// Sweeps and accelerations of projected SOR.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub sweeps: usize,
    pub accelerations: usize,
}

/// How an iteration went.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    /// Conjugate-gradient iterations in all.
    pub iterations: usize,
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
            residual: 0.0,
            converged,
        }
    }
}

/// What an iteration is asked for, when it ends, converged or not, and who is told of it.
pub(crate) struct Control<'a> {
    /// Energy-norm residual asked, over the energy of the solution.
    pub tolerance: f64,
    /// Most iterations.
    pub iterations: usize,
    /// Who may stop it.
    pub options: &'a Options,
    /// Told of every update of the contact set, with the state as it is then.
    pub tell: &'a dyn Fn(&SetUpdate, &State),
}

impl Control<'_> {
    /// Whether it is to end after so many iterations.
    pub fn reached(&self, iterations: usize) -> bool {
        iterations >= self.iterations || self.options.stopped()
    }
}

/// What happened with one contact set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetUpdate {
    /// Nodes that touch.
    pub contact_nodes: usize,
    /// Conjugate-gradient iterations with this set.
    pub iterations: usize,
    /// Residual that they reached.
    pub residual: f64,
    /// Of the prediction of this set; the iteration on the set is one more acceleration.
    pub counts: Counts,
    /// Energy of the forces accepted so far, of the part that is solved [J].
    pub energy: f64,
}
