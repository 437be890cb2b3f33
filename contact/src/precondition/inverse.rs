//! A body's preconditioner, in two halves with the contact plane between them.

use faer::Mat;

use crate::precondition::factored::FactoredInverse;
use crate::precondition::mounted::MountedInverse;
use crate::precondition::planewise::{InverseWork, PlanewiseInverse};

/// M^-1, spectrally equivalent to the inverse of the stiffness.
///
/// A beginning gives how a residual would close the gap; then the forces on the contact plane that
/// answer to it are known, and the finish takes them into the step. So one application serves both.
pub(crate) enum Inverse {
    /// Of a body that nothing but faces of its tensor grid hold.
    Planewise(Box<PlanewiseInverse>),
    /// Of a body with a mount.
    Mounted(Box<MountedInverse>),
    /// Of a solid, exact.
    Factored(FactoredInverse),
}

/// Calls a method of whichever inverse it is.
macro_rules! each {
    ($self:ident, $method:ident($($argument:expr),*)) => {
        match $self {
            Inverse::Planewise(inverse) => inverse.$method($($argument),*),
            Inverse::Mounted(inverse) => inverse.$method($($argument),*),
            Inverse::Factored(inverse) => inverse.$method($($argument),*),
        }
    };
}

impl Inverse {
    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        each!(self, work())
    }

    /// `closing` += B M^-1 `residual`; M^-1 `residual` stays in `work`.
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        each!(self, begin(residual, closing, work))
    }

    /// `step` = M^-1 (residual - B^T m) for the forces m on nodes.
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        each!(self, finish(multipliers, step, work))
    }

    /// `closing` += B M^-1 B^T f for the forces f on nodes.
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut InverseWork) {
        match self {
            Inverse::Planewise(inverse) => inverse.respond(forces, closing),
            Inverse::Mounted(inverse) => inverse.respond(forces, closing, work),
            Inverse::Factored(inverse) => inverse.respond(forces, closing, work),
        }
    }

    /// B M^-1 B^T between plane nodes, and that with the fast-diagonalisation part scaled to
    /// elasticity's response.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        each!(self, green(nodes))
    }
}
