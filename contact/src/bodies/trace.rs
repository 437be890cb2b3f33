//! How a body's displacements close the gap over the nodes of the contact plane.

use std::sync::Arc;

use crate::bodies::columns::Columns;
use crate::bodies::mortar::Mortar;

/// B: from displacements, component after component, to the closing of the gap on the plane's nodes, x fastest. It has the
/// vertical displacements with the sign of the body's side.
pub(crate) enum Trace {
    /// Nodes of the body that are nodes of the plane.
    Nodes {
        columns: Columns,
        /// Where their vertical displacements begin in the body's vector, x fastest.
        start: usize,
        /// +1 for a body below, -1 for one above.
        sign: f64,
    },
    /// Means over nodes of a body above that has its own.
    Means(Arc<Mortar>),
}

impl Trace {
    /// `closing` += B `u`.
    pub fn add_closing(&self, u: &[f64], closing: &mut [f64]) {
        match self {
            Trace::Nodes {
                columns,
                start,
                sign,
            } => {
                let [nx, ny] = columns.count;
                for j in 0..ny {
                    for i in 0..nx {
                        closing[columns.node([i, j])] += sign * u[start + j * nx + i];
                    }
                }
            }
            Trace::Means(mortar) => mortar.add_closing(u, closing),
        }
    }

    /// `out` += B^T f for the forces (node, value).
    pub fn add_forces(&self, forces: &[(usize, f64)], out: &mut [f64]) {
        match self {
            Trace::Nodes {
                columns,
                start,
                sign,
            } => {
                for &(node, force) in forces {
                    if let Some([i, j]) = columns.local(node) {
                        out[start + j * columns.count[0] + i] += sign * force;
                    }
                }
            }
            Trace::Means(mortar) => mortar.add_forces(forces, 1.0, out),
        }
    }
}
