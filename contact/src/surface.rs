//! The contact plane: nodes that may touch, and the Green's matrix of the preconditioner between them.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use kufe_fem::FastDiagonal;
use rayon::prelude::*;

/// The surface response of one body under the fast-diagonalisation operator P.
///
/// With the modes of the vertical displacement, the Green's matrix of P on the contact plane is
/// G_ij = sum over a, b of Qx[i,a] Qx[j,a] Qy[i,b] Qy[j,b] T_ab, T_ab = sum over c of Qz[plane,c]^2 / Lambda_abc.
pub(crate) struct SurfaceModes {
    /// Modes of x, nodes by modes.
    pub x: Mat<f64>,
    /// Modes of y, nodes by modes.
    pub y: Mat<f64>,
    /// Values of the z modes on the contact plane.
    pub z: Vec<f64>,
    /// T, modes of x by modes of y [m/N].
    pub table: Mat<f64>,
}

impl SurfaceModes {
    /// The modes of vertical displacement on plane `plane` of the z axis.
    pub fn new(preconditioner: &FastDiagonal, plane: usize) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| preconditioner.axis_modes(2, axis));
        let values: Vec<f64> = (0..z.values.len()).map(|m| z.vectors[(plane, m)]).collect();
        let (mx, my) = (x.values.len(), y.values.len());
        let inverse = preconditioner.inverse(2);
        let mut table = Mat::<f64>::zeros(mx, my);
        for (c, value) in values.iter().enumerate() {
            for b in 0..my {
                for a in 0..mx {
                    table[(a, b)] += value * value * inverse[(c * my + b) * mx + a];
                }
            }
        }
        SurfaceModes {
            x: x.vectors.clone(),
            y: y.vectors.clone(),
            z: values,
            table,
        }
    }

    /// Vertical displacement on the plane from a modal field given on the plane's modes.
    pub fn to_nodes(&self, modal: MatRef<'_, f64>) -> Mat<f64> {
        let half = product(self.x.as_ref(), modal);
        product(half.as_ref(), self.y.transpose())
    }

    /// Modal form of nodal forces on the plane.
    pub fn to_modes(&self, nodal: MatRef<'_, f64>) -> Mat<f64> {
        let half = product(self.x.transpose(), nodal);
        product(half.as_ref(), self.y.as_ref())
    }

    /// G between the nodes (i, j) of `nodes`, times `scale`, added to `green`.
    ///
    /// The sum over the modes of y is done once for each pair of rows that occurs, the sum over the modes of
    /// x once for each pair of nodes.
    pub fn add_green(&self, nodes: &[[usize; 2]], scale: f64, green: &mut Mat<f64>) {
        let (mx, my) = (self.x.ncols(), self.y.ncols());
        let mut rows: Vec<usize> = nodes.iter().map(|node| node[1]).collect();
        rows.sort_unstable();
        rows.dedup();
        let row_of: Vec<usize> = nodes
            .iter()
            .map(|node| rows.partition_point(|&r| r < node[1]))
            .collect();
        // weights of the pair (p, q) of rows: sum over b of Qy[p,b] Qy[q,b] T_ab, for p <= q.
        let pair = |p: usize, q: usize| {
            if p <= q {
                q * (q + 1) / 2 + p
            } else {
                p * (p + 1) / 2 + q
            }
        };
        let pairs: Vec<[usize; 2]> = (0..rows.len())
            .flat_map(|q| (0..=q).map(move |p| [p, q]))
            .collect();
        let mut weights = vec![0.0; pairs.len() * mx];
        weights
            .par_chunks_mut(mx)
            .zip(&pairs)
            .for_each(|(weight, &[p, q])| {
                for b in 0..my {
                    let factor = self.y[(rows[p], b)] * self.y[(rows[q], b)];
                    for (a, w) in weight.iter_mut().enumerate() {
                        *w += factor * self.table[(a, b)];
                    }
                }
            });
        let modes_of: Vec<Vec<f64>> = nodes
            .iter()
            .map(|node| (0..mx).map(|a| self.x[(node[0], a)]).collect())
            .collect();
        let n = nodes.len();
        let columns: Vec<Vec<f64>> = (0..n)
            .into_par_iter()
            .map(|j| {
                let mut scaled = vec![0.0; mx];
                let mut last = usize::MAX;
                (0..=j)
                    .map(|i| {
                        if row_of[i] != last {
                            last = row_of[i];
                            let start = pair(row_of[i], row_of[j]) * mx;
                            for ((s, w), q) in scaled
                                .iter_mut()
                                .zip(&weights[start..start + mx])
                                .zip(&modes_of[j])
                            {
                                *s = w * q;
                            }
                        }
                        modes_of[i]
                            .iter()
                            .zip(&scaled)
                            .map(|(m, s)| m * s)
                            .sum::<f64>()
                    })
                    .collect()
            })
            .collect();
        for (j, column) in columns.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                green[(i, j)] += scale * value;
                if i != j {
                    green[(j, i)] += scale * value;
                }
            }
        }
    }
}

fn product(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.nrows(), right.ncols());
    matmul(out.as_mut(), Accum::Replace, left, right, 1.0, Par::Seq);
    out
}
