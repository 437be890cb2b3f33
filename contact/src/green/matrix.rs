//! The Green's matrix of the contact plane's candidates in either of its forms.

use std::borrow::Cow;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

use crate::green::modal::ModalGreen;

/// Largest number of candidates for which the matrix is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StorageLimit {
    /// For bodies that are constrained only on faces of their grids.
    pub faces: usize,
    /// For a runner with a mount or with hexahedra of its own.
    pub mounted: usize,
}

impl StorageLimit {
    /// The usual limits.
    ///
    /// From about 300 contact nodes (1000 candidates) on, the product through the modes is as fast
    /// as the stored matrix. At 2,700 contact nodes on a bed it takes a third of the time and a
    /// sixth of the memory. With a mount's matrix it is at best as fast, and the memory of the
    /// matrices is the limit, 0.8 GB each.
    pub const USUAL: StorageLimit = StorageLimit {
        faces: 2_500,
        mounted: 10_000,
    };
}

/// Green's matrix G between the candidates of contact [m/N].
pub(crate) enum Green<'a> {
    /// Every entry.
    Dense(Cow<'a, Mat<f64>>),
    /// Products through the modes of the plane.
    Modal(Box<ModalGreen<'a>>),
}

impl Green<'_> {
    /// G_ii [m/N]; where the matrix is not stored, without the contribution of a mount or a solid.
    pub fn diagonal(&self, i: usize) -> f64 {
        match self {
            Green::Dense(matrix) => matrix[(i, i)],
            Green::Modal(modal) => modal.diagonal[i],
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
                let deflection = modal.times(force);
                out.iter_mut().zip(deflection).for_each(|(o, d)| *o += d);
            }
            Green::Modal(_) => {}
        }
    }

    /// Gauss-Seidel sweep: sets `force[i] = update(i, force[i], deflection[i])` for one node after
    /// another and keeps `deflection` = G `force`.
    pub fn sweep(
        &self,
        force: &mut [f64],
        deflection: &mut [f64],
        update: impl Fn(usize, f64, f64) -> f64,
    ) {
        match self {
            Green::Dense(matrix) => {
                for i in 0..force.len() {
                    let next = update(i, force[i], deflection[i]);
                    let change = next - force[i];
                    if change != 0.0 {
                        force[i] = next;
                        for (d, g) in deflection.iter_mut().zip(matrix.col(i).iter()) {
                            *d += change * g;
                        }
                    }
                }
            }
            Green::Modal(modal) => modal.sweep(force, deflection, update),
        }
    }

    /// Accuracy of the forces and gaps of a solve on one set, relative to the largest, as limited
    /// by rounding and inner iterations.
    pub fn precision(&self) -> f64 {
        match self {
            Green::Dense(_) => 1e-12,
            Green::Modal(_) => 1e-9,
        }
    }
}

// The rectangle of the contact plane that the candidates lie in, and products over it.

/// The smallest rectangle of plane nodes around the candidates; the axis of its longer side comes
/// first.
pub(crate) struct CandidateRectangle {
    /// Node indices along x and along y.
    pub along: [std::ops::Range<usize>; 2],
    /// The axes of its longer and of its shorter side.
    pub axes: [usize; 2],
    /// Indices of each candidate in the rectangle, along the longer side first.
    pub places: Vec<[usize; 2]>,
    /// The candidates of each line across the longer side: index on the line and number.
    pub lines: Vec<Vec<[usize; 2]>>,
}

impl CandidateRectangle {
    /// The rectangle around `candidates`, nodes of a plane of `width` nodes along x.
    pub fn new(candidates: &[usize], width: usize) -> Self {
        let at = |node: &usize| [node % width, node / width];
        let along = [0, 1].map(|axis| {
            let places = || candidates.iter().map(|node| at(node)[axis]);
            places().min().unwrap_or(0)..places().max().map_or(0, |last| last + 1)
        });
        let axes = if along[0].len() >= along[1].len() {
            [0, 1]
        } else {
            [1, 0]
        };
        let places: Vec<[usize; 2]> = candidates
            .iter()
            .map(|node| axes.map(|axis| at(node)[axis] - along[axis].start))
            .collect();
        let mut lines = vec![Vec::new(); along[axes[0]].len()];
        for (number, &[line, place]) in places.iter().enumerate() {
            lines[line].push([place, number]);
        }
        CandidateRectangle {
            along,
            axes,
            places,
            lines,
        }
    }

    /// Nodes along its longer and its shorter side.
    pub fn shape(&self) -> [usize; 2] {
        self.axes.map(|axis| self.along[axis].len())
    }

    /// Field on the rectangle with the values of some candidates, 0 elsewhere.
    pub fn scatter(&self, values: impl Iterator<Item = (usize, f64)>) -> Mat<f64> {
        let [long, short] = self.shape();
        let mut field = Mat::zeros(long, short);
        for (number, value) in values {
            let [i, j] = self.places[number];
            field[(i, j)] = value;
        }
        field
    }

    /// Value of a field on the rectangle at a candidate.
    pub fn at(&self, field: &Mat<f64>, number: usize) -> f64 {
        let [i, j] = self.places[number];
        field[(i, j)]
    }
}

/// Linear operator on fields of the rectangle that is diagonal in the product basis of both axes'
/// modes, F -> X (T o (X^T F Y)) Y^T.
pub(crate) struct SeparableOperator {
    /// X^T: modes by nodes of the longer side.
    pub long: Mat<f64>,
    /// Y: nodes of the shorter side by modes.
    pub short: Mat<f64>,
    /// T: a factor for each mode of the longer side and each of the shorter.
    pub table: Mat<f64>,
}

impl SeparableOperator {
    /// X (T o (X^T F Y)) Y^T.
    pub fn times(&self, field: &Mat<f64>) -> Mat<f64> {
        let mut modal = self.to_modes(field);
        for (column, factors) in modal.col_iter_mut().zip(self.table.col_iter()) {
            for (value, factor) in column.iter_mut().zip(factors.iter()) {
                *value *= factor;
            }
        }
        let half = product(modal.as_ref(), self.short.transpose());
        product(self.long.transpose(), half.as_ref())
    }

    /// X^T F Y.
    pub fn to_modes(&self, field: &Mat<f64>) -> Mat<f64> {
        let half = product(self.long.as_ref(), field.as_ref());
        product(half.as_ref(), self.short.as_ref())
    }

    /// Adds the changes of the values on a line to their modal form: an update of rank one.
    fn add_line(&self, line: usize, changes: &[f64], modal: &mut Mat<f64>) {
        let along = self.long.col(line);
        for (b, column) in modal.col_iter_mut().enumerate() {
            let modes = self.short.col(b);
            let share: f64 = modes.iter().zip(changes).map(|(y, c)| y * c).sum();
            for (value, x) in column.iter_mut().zip(along.iter()) {
                *value += x * share;
            }
        }
    }

    /// Adds the deflection of a line under the modal forces `load`, and the block of G between the
    /// line's own nodes.
    fn add_line_response(
        &self,
        line: usize,
        load: &Mat<f64>,
        deflection: &mut [f64],
        line_green: &mut Mat<f64>,
    ) {
        let along = self.long.col(line);
        let count = self.short.ncols();
        let (mut modal, mut weights) = (vec![0.0; count], vec![0.0; count]);
        for b in 0..count {
            let sums = (along.iter()).zip(self.table.col(b).iter().zip(load.col(b).iter()));
            for (x, (t, l)) in sums {
                modal[b] += x * t * l;
                weights[b] += x * x * t;
            }
        }
        for (i, deflection) in deflection.iter_mut().enumerate() {
            let row = self.short.row(i);
            *deflection += row.iter().zip(&modal).map(|(y, v)| y * v).sum::<f64>();
        }
        let weighted = Mat::from_fn(deflection.len(), count, |i, b| {
            self.short[(i, b)] * weights[b]
        });
        *line_green += product(weighted.as_ref(), self.short.transpose());
    }

    /// The operator's diagonal as a field on the rectangle.
    pub fn diagonal(&self) -> Mat<f64> {
        let squared = |m: &Mat<f64>| Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].powi(2));
        let half = product(self.table.as_ref(), squared(&self.short).transpose());
        product(squared(&self.long).transpose(), half.as_ref())
    }
}

/// Rows that one task computes; fixed, so that bits do not depend on the number of threads.
const ROWS: usize = 128;

/// The matrix product left right, computed by tasks of [`ROWS`] rows.
pub(crate) fn product(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.nrows(), right.ncols());
    out.par_row_chunks_mut(ROWS)
        .enumerate()
        .for_each(|(k, mut part)| {
            let rows = left.subrows(k * ROWS, part.nrows());
            matmul(part.as_mut(), Accum::Replace, rows, right, 1.0, Par::Seq);
        });
    out
}

// Projected SOR where the Green's matrix is not stored.

/// One Gauss-Seidel sweep over the lines of the rectangle.
///
/// It sets a candidate's force to `update` of the node, its force and its deflection, of which
/// `others` is the part that the modes do not give. The forces are kept in the modes of the plane,
/// L = Qx^T F Qy. The deflection of one line, and its change by the line's own forces, are sums
/// over the modes of the other axis; the line's change of L has rank one. So a sweep costs as much
/// as a product with G, and every node sees the current forces.
pub(crate) fn sweep_lines(
    window: &CandidateRectangle,
    forms: &[SeparableOperator],
    others: &[f64],
    force: &mut [f64],
    update: impl Fn(usize, f64, f64) -> f64,
) {
    let field = window.scatter(force.iter().copied().enumerate());
    let mut loads: Vec<Mat<f64>> = forms.iter().map(|form| form.to_modes(&field)).collect();
    let [_, short] = window.shape();
    for (line, nodes) in window.lines.iter().enumerate() {
        if nodes.is_empty() {
            continue;
        }
        let mut deflection = vec![0.0; short];
        let mut line_green = Mat::<f64>::zeros(short, short);
        for (form, load) in forms.iter().zip(&loads) {
            form.add_line_response(line, load, &mut deflection, &mut line_green);
        }
        let mut changes = vec![0.0; short];
        for &[place, number] in nodes {
            let next = update(number, force[number], deflection[place] + others[number]);
            let change = next - force[number];
            if change != 0.0 {
                force[number] = next;
                changes[place] = change;
                for (d, g) in deflection.iter_mut().zip(line_green.col(place).iter()) {
                    *d += change * g;
                }
            }
        }
        if changes.iter().any(|c| *c != 0.0) {
            for (form, load) in forms.iter().zip(&mut loads) {
                form.add_line(line, &changes, load);
            }
        }
    }
}
