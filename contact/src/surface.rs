//! The contact plane: nodes that may touch, and the Green's matrix of the preconditioner between them.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use kufe_fem::LayeredDiagonal;
use rayon::prelude::*;

/// The surface response of one body under the fast-diagonalisation operator P.
///
/// With the modes of the vertical displacement, the Green's matrix of P on the contact plane is
/// G_ij = sum over a, b of Qx[i,a] Qx[j,a] Qy[i,b] Qy[j,b] T_ab, T the response of each pair of modes.
pub(crate) struct SurfaceModes {
    /// Modes of x, nodes by modes.
    pub x: Mat<f64>,
    /// Modes of y, nodes by modes.
    pub y: Mat<f64>,
    /// T, modes of x by modes of y [m/N].
    pub table: Mat<f64>,
}

impl SurfaceModes {
    /// The modes of vertical displacement on the plane that elimination ends on.
    pub fn new(preconditioner: &LayeredDiagonal) -> Self {
        let [x, y] = preconditioner.plane_modes();
        SurfaceModes {
            x: x.vectors.clone(),
            y: y.vectors.clone(),
            table: preconditioner.end_response().to_owned(),
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

    /// G between the nodes (i, j) of `nodes`, which come row by row, times `scale`, added to `green`.
    ///
    /// The sum over the modes of y is done once for each pair of rows that occurs, the sum over the modes of
    /// x as one product for that pair: X_p diag(sum over b of Qy[p,b] Qy[q,b] T_ab) X_q^T.
    pub fn add_green(&self, nodes: &[[usize; 2]], scale: f64, green: &mut Mat<f64>) {
        let mut rows: Vec<Row> = Vec::new();
        for (place, &[i, j]) in nodes.iter().enumerate() {
            match rows.last_mut().filter(|row| row.j == j) {
                Some(row) => row.columns.push(i),
                None => rows.push(Row {
                    j,
                    first: place,
                    columns: vec![i],
                }),
            }
        }
        let blocks: Vec<Vec<Mat<f64>>> = rows
            .par_iter()
            .enumerate()
            .map(|(q, to)| {
                let right = self.rows_of_x(&to.columns);
                rows[..=q]
                    .iter()
                    .map(|from| self.between(from, to, &right, scale))
                    .collect()
            })
            .collect();
        for (to, blocks) in rows.iter().zip(&blocks) {
            for (from, block) in rows.iter().zip(blocks) {
                for (j, column) in block.col_iter().enumerate() {
                    for (i, value) in column.iter().enumerate() {
                        let (a, b) = (from.first + i, to.first + j);
                        green[(a, b)] += value;
                        if from.j != to.j {
                            green[(b, a)] += value;
                        }
                    }
                }
            }
        }
    }

    /// G between two rows of nodes; `right` holds the modes of x at the second's.
    fn between(&self, from: &Row, to: &Row, right: &Mat<f64>, scale: f64) -> Mat<f64> {
        let (mx, my) = (self.x.ncols(), self.y.ncols());
        let mut weights = vec![0.0; mx];
        for b in 0..my {
            let factor = scale * self.y[(from.j, b)] * self.y[(to.j, b)];
            for (weight, t) in weights.iter_mut().zip(self.table.col(b).iter()) {
                *weight += factor * t;
            }
        }
        let mut left = self.rows_of_x(&from.columns);
        for (a, weight) in weights.iter().enumerate() {
            left.col_mut(a).iter_mut().for_each(|v| *v *= weight);
        }
        let block = product(left.as_ref(), right.transpose());
        if from.j == to.j {
            // Symmetric to the last bit.
            return Mat::from_fn(block.nrows(), block.ncols(), |i, j| {
                0.5 * (block[(i, j)] + block[(j, i)])
            });
        }
        block
    }

    fn rows_of_x(&self, columns: &[usize]) -> Mat<f64> {
        Mat::from_fn(columns.len(), self.x.ncols(), |i, a| {
            self.x[(columns[i], a)]
        })
    }
}

/// Nodes that share their y, and the place of the first of them.
struct Row {
    j: usize,
    first: usize,
    columns: Vec<usize>,
}

fn product(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.nrows(), right.ncols());
    matmul(out.as_mut(), Accum::Replace, left, right, 1.0, Par::Seq);
    out
}
