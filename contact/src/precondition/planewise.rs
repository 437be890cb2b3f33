//! Preconditioner of a body that is constrained only on faces of its grid: fast diagonalisation in
//! x and y, elimination in z.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use kufe_fem::{AxisModes, End, PlanewiseDiagonal, TensorOperator};
use rayon::prelude::*;

/// P^-1 by elimination over the layers, which ends at the contact plane.
pub(crate) struct PlanewiseInverse {
    pub preconditioner: PlanewiseDiagonal,
    pub basis: PlaneBasis,
    pub columns: Columns,
    side: Side,
    /// Factor by which the true surface response exceeds that of P on a half-space.
    pub response: f64,
}

impl PlanewiseInverse {
    /// The inverse with the contact plane at the end of z that faces the other body.
    pub fn new(operator: &TensorOperator, columns: Columns, side: Side) -> Self {
        let end = match side {
            Side::Below => End::High,
            Side::Above => End::Low,
        };
        let preconditioner = PlanewiseDiagonal::new(operator, end);
        let [x, y] = preconditioner.plane_modes();
        PlanewiseInverse {
            basis: PlaneBasis::new(x, y),
            columns,
            side,
            response: surface_response(operator),
            preconditioner,
        }
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        InverseWork {
            intermediate: vec![0.0; self.preconditioner.mode_count()],
            ..InverseWork::default()
        }
    }

    /// `closing` += B P^-1 r; see [`crate::bodies::elastic_body::ElasticBody::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        self.preconditioner.gather(residual, &mut work.intermediate);
        self.add_closing(self.preconditioner.gathered(&work.intermediate), closing);
    }

    /// `closing` += B P^-1 r from the modal values of r that the elimination gathered on the
    /// contact plane.
    fn add_closing(&self, gathered: MatRef<'_, f64>, closing: &mut [f64]) {
        let response = self.preconditioner.end_response();
        let modal = Mat::from_fn(gathered.nrows(), gathered.ncols(), |a, b| {
            gathered[(a, b)] * response[(a, b)]
        });
        let trace = self.basis.to_nodes(modal.as_ref());
        let value = |[i, j]: [usize; 2]| self.side.sign() * trace[(i, j)];
        self.columns.add_to_plane(closing, value);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::finish`].
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        let intermediate = &mut work.intermediate;
        self.subtract_forces(multipliers, self.preconditioner.gathered_mut(intermediate));
        self.preconditioner.spread(intermediate, step);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::respond`].
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], _: &mut InverseWork) {
        let [mx, my] = self.basis.mode_shape();
        let mut gathered = Mat::<f64>::zeros(mx, my);
        self.subtract_forces(forces, gathered.as_mut());
        gathered *= faer::Scale(-1.0);
        self.add_closing(gathered.as_ref(), closing);
    }

    /// `gathered` -= B^T m for the forces m on nodes.
    fn subtract_forces(&self, multipliers: &[(usize, f64)], mut gathered: MatMut<'_, f64>) {
        let plane = self.columns.field(multipliers);
        let load = self.basis.to_modes(plane.as_ref());
        gathered -= faer::Scale(self.side.sign()) * load;
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::green`]; the second one is scaled to
    /// elasticity's response.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let local = self.columns.all_local(nodes);
        let green = self.basis.green(self.preconditioner.end_response(), &local);
        let scaled = faer::Scale(self.response) * &green;
        [green, scaled]
    }
}

// The modes of x and y on a horizontal plane, and Green's matrices between its nodes.

/// The modes of x and of y on a plane of nodes, each a matrix of nodes by modes.
///
/// With a response T_ab of each pair of modes, the Green's matrix between nodes i and j is
/// G_ij = sum over a, b of Qx[i,a] Qx[j,a] Qy[i,b] Qy[j,b] T_ab.
pub(crate) struct PlaneBasis {
    x: Mat<f64>,
    y: Mat<f64>,
}

impl PlaneBasis {
    pub fn new(x: &AxisModes, y: &AxisModes) -> Self {
        PlaneBasis {
            x: x.vectors.clone(),
            y: y.vectors.clone(),
        }
    }

    /// The modes of one axis.
    pub fn along(&self, axis: usize) -> MatRef<'_, f64> {
        [&self.x, &self.y][axis].as_ref()
    }

    /// Modes of x and of y.
    pub fn mode_shape(&self) -> [usize; 2] {
        [self.x.ncols(), self.y.ncols()]
    }

    /// Nodal values from modal values.
    pub fn to_nodes(&self, modal: MatRef<'_, f64>) -> Mat<f64> {
        let half = product(self.x.as_ref(), modal);
        product(half.as_ref(), self.y.transpose())
    }

    /// Modal form of nodal forces.
    pub fn to_modes(&self, nodal: MatRef<'_, f64>) -> Mat<f64> {
        let half = product(self.x.transpose(), nodal);
        product(half.as_ref(), self.y.as_ref())
    }

    /// G between the nodes (i, j) of `from` and of `to`.
    ///
    /// For each pair of rows of nodes the sum over the modes of y is computed once, and the sum
    /// over the modes of x as a product: X_p diag(sum over b of Qy[p,b] Qy[q,b] T_ab) X_q^T. Nodes
    /// of one y should be adjacent in the list.
    pub fn green_between(
        &self,
        table: MatRef<'_, f64>,
        from: &[[usize; 2]],
        to: &[[usize; 2]],
    ) -> Mat<f64> {
        let (from_rows, to_rows) = (rows(from), rows(to));
        let blocks = self.blocks(table, &to_rows, |_| &from_rows[..]);
        let mut green = Mat::zeros(from.len(), to.len());
        for (to, blocks) in to_rows.iter().zip(&blocks) {
            for (from, block) in from_rows.iter().zip(blocks) {
                let (height, width) = (block.nrows(), block.ncols());
                let part = green.as_mut();
                part.submatrix_mut(from.first, to.first, height, width)
                    .copy_from(block);
            }
        }
        green
    }

    /// G between nodes (i, j), symmetric to the last bit.
    pub fn green(&self, table: MatRef<'_, f64>, nodes: &[[usize; 2]]) -> Mat<f64> {
        let rows = rows(nodes);
        let mut green = Mat::zeros(nodes.len(), nodes.len());
        let blocks = self.blocks(table, &rows, |to| &rows[..=to]);
        for (q, (to, blocks)) in rows.iter().zip(&blocks).enumerate() {
            for (p, (from, block)) in rows.iter().zip(blocks).enumerate() {
                for (j, column) in block.col_iter().enumerate() {
                    for (i, &value) in column.iter().enumerate() {
                        let (a, b) = (from.first + i, to.first + j);
                        let value = if p == q {
                            0.5 * (value + block[(j, i)])
                        } else {
                            value
                        };
                        green[(a, b)] = value;
                        green[(b, a)] = value;
                    }
                }
            }
        }
        green
    }

    /// G between each row of `to` and the rows that `from` returns for it.
    fn blocks<'a>(
        &self,
        table: MatRef<'_, f64>,
        to: &[Row],
        from: impl Fn(usize) -> &'a [Row] + Sync,
    ) -> Vec<Vec<Mat<f64>>> {
        to.par_iter()
            .enumerate()
            .map(|(q, to)| {
                let right = self.rows_of_x(&to.columns);
                let blocks = from(q).iter();
                blocks
                    .map(|from| self.block(table, from, to, &right))
                    .collect()
            })
            .collect()
    }

    /// G between two rows of nodes; `right` holds the modes of x at the nodes of `to`.
    fn block(&self, table: MatRef<'_, f64>, from: &Row, to: &Row, right: &Mat<f64>) -> Mat<f64> {
        let [mx, my] = self.mode_shape();
        let mut weights = vec![0.0; mx];
        for b in 0..my {
            let factor = self.y[(from.j, b)] * self.y[(to.j, b)];
            for (weight, t) in weights.iter_mut().zip(table.col(b).iter()) {
                *weight += factor * t;
            }
        }
        let mut left = self.rows_of_x(&from.columns);
        for (a, weight) in weights.iter().enumerate() {
            left.col_mut(a).iter_mut().for_each(|v| *v *= weight);
        }
        product(left.as_ref(), right.transpose())
    }

    fn rows_of_x(&self, columns: &[usize]) -> Mat<f64> {
        Mat::from_fn(columns.len(), self.x.ncols(), |i, a| {
            self.x[(columns[i], a)]
        })
    }
}

/// Adjacent nodes of one y, and the index of the first of them in the list.
struct Row {
    j: usize,
    first: usize,
    columns: Vec<usize>,
}

/// Nodes (i, j) grouped into rows of one j.
fn rows(nodes: &[[usize; 2]]) -> Vec<Row> {
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
    rows
}

fn product(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.nrows(), right.ncols());
    matmul(out.as_mut(), Accum::Replace, left, right, 1.0, Par::Seq);
    out
}

// Ratio of a body's surface compliance to that of its preconditioner.

/// Factor by which the true surface response exceeds that of P on a half-space.
///
/// Both are 1 / |k| in the wave number: (1 - nu) / mu for elasticity, 1 / sqrt(mu (lambda + 2 mu))
/// for P.
pub(crate) fn surface_response(operator: &TensorOperator) -> f64 {
    let material = operator.material;
    let stiffness_ratio = material.uniaxial_strain_modulus() / material.shear_modulus();
    (1.0 - material.poissons_ratio()) * stiffness_ratio.sqrt()
}

// Workspace of a preconditioner.

/// Vectors that applications reuse.
#[derive(Default)]
pub(crate) struct InverseWork {
    /// State between the first and the second pass: modal values, or the residual itself.
    pub intermediate: Vec<f64>,
    /// State between the first and the second pass of the motions of a beam.
    pub motion: Vec<f64>,
    pub scratch: Vec<f64>,
    /// A vector node by node.
    pub by_node: Vec<f64>,
    /// Sums of a projection's tasks.
    pub sums: Vec<f64>,
}

// The columns of the contact plane that a body has, and its side of the plane.

/// A rectangle of the contact plane's nodes: the vertical columns of nodes of one body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Columns {
    /// First column along x and along y.
    pub first: [usize; 2],
    /// Number of columns along x and along y.
    pub count: [usize; 2],
    /// Number of the plane's nodes along x.
    pub plane_width: usize,
}

impl Columns {
    /// All columns of a plane of so many nodes along x and along y.
    pub fn of_plane(count: [usize; 2]) -> Self {
        Columns {
            first: [0, 0],
            count,
            plane_width: count[0],
        }
    }

    /// A plane node's column along x and y in this rectangle.
    pub fn local(&self, node: usize) -> Option<[usize; 2]> {
        let i = (node % self.plane_width).checked_sub(self.first[0])?;
        let j = (node / self.plane_width).checked_sub(self.first[1])?;
        (i < self.count[0] && j < self.count[1]).then_some([i, j])
    }

    /// Columns of nodes that all lie in this rectangle.
    ///
    /// # Panics
    /// If a node lies outside.
    pub fn all_local(&self, nodes: &[usize]) -> Vec<[usize; 2]> {
        let local = nodes.iter().map(|&node| self.local(node));
        let all: Option<Vec<[usize; 2]>> = local.collect();
        all.unwrap_or_else(|| panic!("contact candidates over the body"))
    }

    /// The values of plane nodes in this rectangle, columns along x by those along y; 0 elsewhere.
    pub fn field(&self, values: &[(usize, f64)]) -> Mat<f64> {
        let mut field = Mat::zeros(self.count[0], self.count[1]);
        for &(node, value) in values {
            if let Some([i, j]) = self.local(node) {
                field[(i, j)] = value;
            }
        }
        field
    }

    /// `plane` += a value for each column of this rectangle.
    pub fn add_to_plane(&self, plane: &mut [f64], value: impl Fn([usize; 2]) -> f64) {
        for j in 0..self.count[1] {
            for i in 0..self.count[0] {
                plane[self.node([i, j])] += value([i, j]);
            }
        }
    }

    /// The plane node of a column of this rectangle.
    pub fn node(&self, [i, j]: [usize; 2]) -> usize {
        (self.first[1] + j) * self.plane_width + self.first[0] + i
    }
}

/// Side of the contact plane on which a body lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The body below, the ice: rising closes the gap.
    Below,
    /// The body above, the runner: rising opens it.
    Above,
}

impl Side {
    /// Ratio of the closing of the gap to the body's vertical displacement.
    pub const fn sign(self) -> f64 {
        match self {
            Side::Below => 1.0,
            Side::Above => -1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe_fem::Axis;

    /// Compared with the sum as it is written, for nodes in rows, alone, and twice in one row.
    #[test]
    fn green_is_the_sum_over_both_axes_modes() {
        let [x, y] = [7, 5].map(|n: usize| {
            let nodes: Vec<f64> = (0..n).map(|i| 1.2f64.powi(i as i32)).collect();
            Axis::new(&nodes).modes([false, true])
        });
        let basis = PlaneBasis::new(&x, &y);
        let [mx, my] = basis.mode_shape();
        let table = Mat::from_fn(mx, my, |a, b| 1.0 / (1.0 + a as f64 + 0.5 * b as f64));
        let from = [[0, 0], [2, 0], [3, 0], [1, 2], [1, 3], [4, 3], [0, 0]];
        let to = [[1, 1], [2, 0], [3, 0]];
        let expected = |[i, j]: [usize; 2], [k, l]: [usize; 2]| -> f64 {
            let mut sum = 0.0;
            for a in 0..mx {
                for b in 0..my {
                    sum += x.vectors[(i, a)]
                        * x.vectors[(k, a)]
                        * y.vectors[(j, b)]
                        * y.vectors[(l, b)]
                        * table[(a, b)];
                }
            }
            sum
        };
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-13;
        let between = basis.green_between(table.as_ref(), &from, &to);
        for (i, &node) in from.iter().enumerate() {
            for (j, &other) in to.iter().enumerate() {
                assert!(near(between[(i, j)], expected(node, other)));
            }
        }
        let green = basis.green(table.as_ref(), &from);
        for (i, &node) in from.iter().enumerate() {
            for (j, &other) in from.iter().enumerate() {
                assert!(near(green[(i, j)], expected(node, other)));
                assert_eq!(green[(i, j)], green[(j, i)]);
            }
        }
    }
}
