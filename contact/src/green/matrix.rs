//! The Green's matrix of the contact plane's candidates in either of its forms.

use std::borrow::Cow;

use faer::Mat;

use crate::green::modal::ModalGreen;

/// Most candidates whose matrix is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stored {
    /// Where faces of their grids alone hold the bodies.
    pub faces: usize,
    /// Where a mount holds one, or one has hexahedra of its own.
    pub mounted: usize,
}

impl Stored {
    /// Products are as fast as what is stored from some 300 nodes that touch on, a thousand that may, and at 2,700 that touch on a bed take a third of
    /// the time and a sixth of the memory. Beside a mount's they are as fast at best, and the matrices' memory is the limit, 0.8 GB each.
    pub const USUAL: Stored = Stored {
        faces: 2_500,
        mounted: 10_000,
    };
}

/// G between the nodes that may touch [m/N].
pub(crate) enum Green<'a> {
    /// Every entry.
    Dense(Cow<'a, Mat<f64>>),
    /// Products through the modes of the plane.
    Modal(Box<ModalGreen<'a>>),
}

impl Green<'_> {
    /// What a force moves at its own node, without what a mount or a solid adds where the matrix is not stored.
    pub fn own(&self, i: usize) -> f64 {
        match self {
            Green::Dense(matrix) => matrix[(i, i)],
            Green::Modal(modal) => modal.own[i],
        }
    }

    /// `out` += G f.
    pub fn add_times(&self, force: &[f64], out: &mut [f64]) {
        match self {
            Green::Dense(matrix) => {
                for (j, &f) in force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
                    for (out, g) in out.iter_mut().zip(matrix.col(j).iter()) {
                        *out += f * g;
                    }
                }
            }
            Green::Modal(modal) if force.iter().any(|f| *f != 0.0) => {
                let moved = modal.times(force);
                out.iter_mut().zip(moved).for_each(|(out, m)| *out += m);
            }
            Green::Modal(_) => {}
        }
    }

    /// Sets forces one after another to what `wanted` says for a node, its force and its deflection; `deflection` = G f follows.
    pub fn sweep(
        &self,
        force: &mut [f64],
        deflection: &mut [f64],
        wanted: impl Fn(usize, f64, f64) -> f64,
    ) {
        match self {
            Green::Dense(matrix) => {
                for i in 0..force.len() {
                    let next = wanted(i, force[i], deflection[i]);
                    let change = next - force[i];
                    if change != 0.0 {
                        force[i] = next;
                        for (d, g) in deflection.iter_mut().zip(matrix.col(i).iter()) {
                            *d += change * g;
                        }
                    }
                }
            }
            Green::Modal(modal) => modal.sweep(force, deflection, wanted),
        }
    }

    /// How far rounding and inner iterations leave forces and gaps from those of a set, over the largest.
    pub fn precision(&self) -> f64 {
        match self {
            Green::Dense(_) => 1e-12,
            Green::Modal(_) => 1e-9,
        }
    }
}
