//! The modes of one displacement component on one horizontal plane of a body, and the Green's matrices between such planes.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use kufe_fem::FastDiagonal;
use rayon::prelude::*;

/// The modes of one displacement component on one horizontal plane of a body, under the fast-diagonalisation operator P.
///
/// The Green's matrix of P on the plane is
/// G_ij = sum over a, b of Qx[i,a] Qx[j,a] Qy[i,b] Qy[j,b] T_ab, T_ab = sum over c of Qz[plane,c]^2 / Lambda_abc.
pub(crate) struct PlaneModes {
    /// The displacement component.
    component: usize,
    /// Modes of x, nodes by modes.
    x: Mat<f64>,
    /// Modes of y, nodes by modes.
    y: Mat<f64>,
    /// Values of the z modes on the plane.
    z: Vec<f64>,
    /// T, modes of x by modes of y [m/N].
    table: Mat<f64>,
}

impl PlaneModes {
    /// The modes of displacement component `component` on plane `plane` of the z axis.
    pub fn new(preconditioner: &FastDiagonal, component: usize, plane: usize) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| preconditioner.axis_modes(component, axis));
        let values: Vec<f64> = (0..z.values.len()).map(|m| z.vectors[(plane, m)]).collect();
        let mut modes = PlaneModes {
            component,
            x: x.vectors.clone(),
            y: y.vectors.clone(),
            z: values,
            table: Mat::new(),
        };
        modes.table = modes.table_with(&modes, preconditioner);
        modes
    }

    /// sum over c of Qz[plane,c] Qz[other plane,c] / Lambda_abc, for two planes of one component.
    pub fn table_with(&self, other: &PlaneModes, preconditioner: &FastDiagonal) -> Mat<f64> {
        assert_eq!(self.component, other.component);
        let (mx, my) = (self.x.ncols(), self.y.ncols());
        let inverse = preconditioner.inverse(self.component);
        let mut table = Mat::<f64>::zeros(mx, my);
        for (c, (p, q)) in self.z.iter().zip(&other.z).enumerate() {
            for b in 0..my {
                for a in 0..mx {
                    table[(a, b)] += p * q * inverse[(c * my + b) * mx + a];
                }
            }
        }
        table
    }

    /// Displacement on the plane's nodes from a modal vector of the body.
    pub fn trace(&self, preconditioner: &FastDiagonal, modal: &[f64]) -> Mat<f64> {
        let own = &modal[preconditioner.component_range(self.component)];
        let (mx, my) = (self.x.ncols(), self.y.ncols());
        let mut trace = vec![0.0; mx * my];
        for (layer, value) in own.chunks_exact(mx * my).zip(&self.z) {
            for (t, m) in trace.iter_mut().zip(layer) {
                *t += value * m;
            }
        }
        let half = product(
            self.x.as_ref(),
            MatRef::from_column_major_slice(&trace, mx, my),
        );
        product(half.as_ref(), self.y.transpose())
    }

    /// Subtracts what P^-1 answers to nodal forces on the plane from a modal vector of the body.
    pub fn subtract_load(
        &self,
        preconditioner: &FastDiagonal,
        nodal: MatRef<'_, f64>,
        modal: &mut [f64],
    ) {
        let half = product(self.x.transpose(), nodal);
        let load = product(half.as_ref(), self.y.as_ref());
        let (mx, my) = (load.nrows(), load.ncols());
        let flat: Vec<f64> = (0..mx * my).map(|i| load[(i % mx, i / mx)]).collect();
        modal[preconditioner.component_range(self.component)]
            .par_chunks_mut(mx * my)
            .zip(preconditioner.inverse(self.component).par_chunks(mx * my))
            .zip(&self.z)
            .for_each(|((layer, inverse), value)| {
                for ((m, i), l) in layer.iter_mut().zip(inverse).zip(&flat) {
                    *m -= value * i * l;
                }
            });
    }

    /// G between nodes (i, j) of this plane and of `other`, a plane of the same component, with their [`Self::table_with`].
    pub fn green_between(
        &self,
        table: &Mat<f64>,
        rows: &[[usize; 2]],
        columns: &[[usize; 2]],
    ) -> Mat<f64> {
        let (mx, my) = (self.x.ncols(), self.y.ncols());
        let values: Vec<Vec<f64>> = columns
            .par_iter()
            .map(|&[i, j]| {
                let mut weights = vec![0.0; mx];
                let mut line = usize::MAX;
                rows.iter()
                    .map(|&[k, l]| {
                        if l != line {
                            line = l;
                            weights.fill(0.0);
                            for b in 0..my {
                                let factor = self.y[(l, b)] * self.y[(j, b)];
                                for (a, w) in weights.iter_mut().enumerate() {
                                    *w += factor * table[(a, b)];
                                }
                            }
                            for (a, w) in weights.iter_mut().enumerate() {
                                *w *= self.x[(i, a)];
                            }
                        }
                        (0..mx).map(|a| weights[a] * self.x[(k, a)]).sum()
                    })
                    .collect()
            })
            .collect();
        Mat::from_fn(rows.len(), columns.len(), |i, j| values[j][i])
    }

    /// G between nodes (i, j) of this plane.
    pub fn green(&self, nodes: &[[usize; 2]]) -> Mat<f64> {
        let green = self.green_between(&self.table, nodes, nodes);
        // Symmetric to the last bit.
        Mat::from_fn(nodes.len(), nodes.len(), |i, j| {
            0.5 * (green[(i, j)] + green[(j, i)])
        })
    }
}

fn product(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.nrows(), right.ncols());
    matmul(out.as_mut(), Accum::Replace, left, right, 1.0, Par::Seq);
    out
}
