//! The Green's matrix of the contact plane's candidates in either of its forms.

use std::borrow::Cow;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

use crate::green::modal::ModalGreen;

/// Most candidates whose matrix is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StorageLimit {
    /// Where faces of their grids alone hold the bodies.
    pub faces: usize,
    /// Where a mount holds one, or one has hexahedra of its own.
    pub mounted: usize,
}

impl StorageLimit {
    /// Products are as fast as what is stored from some 300 nodes that touch on, a thousand that
    /// may, and at 2,700 that touch on a bed take a third of the time and a sixth of the memory.
    /// Together with a mount's matrix they are as fast at best, and the matrices' memory is the
    /// limit, 0.8 GB each.
    pub const USUAL: StorageLimit = StorageLimit {
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
    /// Displacement that a unit force causes at its own node, without what a mount or a solid adds
    /// where the matrix is not stored.
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

    /// Sets forces one after another to `wanted` of a node, its force and its
    /// deflection; `deflection` = G f follows.
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

    /// How far rounding and inner iterations leave forces and gaps from those of a set, over the
    /// largest.
    pub fn precision(&self) -> f64 {
        match self {
            Green::Dense(_) => 1e-12,
            Green::Modal(_) => 1e-9,
        }
    }
}

// The rectangle of the contact plane that the candidates lie in, and products over it.

/// The smallest rectangle of plane nodes around the candidates; its longer side is counted first.
pub(crate) struct Window {
    /// First node and number of nodes, along x and along y.
    pub along: [std::ops::Range<usize>; 2],
    /// The axes of its longer and of its shorter side.
    pub axes: [usize; 2],
    /// Place of each candidate, longer side first.
    pub places: Vec<[usize; 2]>,
    /// The candidates of each line across the longer side: place on the line and number.
    pub lines: Vec<Vec<[usize; 2]>>,
}

impl Window {
    /// Around `candidates`, nodes of a plane of `width` nodes along x.
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
        Window {
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

    /// Values at some candidates as a plane field, 0 elsewhere.
    pub fn spread(&self, values: impl Iterator<Item = (usize, f64)>) -> Mat<f64> {
        let [long, short] = self.shape();
        let mut field = Mat::zeros(long, short);
        for (number, value) in values {
            let [i, j] = self.places[number];
            field[(i, j)] = value;
        }
        field
    }

    /// A plane field at a candidate.
    pub fn at(&self, field: &Mat<f64>, number: usize) -> f64 {
        let [i, j] = self.places[number];
        field[(i, j)]
    }
}

/// A quadratic form in the modes of both axes: values on the window, modal form, a factor for each
/// pair of modes, and back.
pub(crate) struct QuadraticForm {
    /// Modes by nodes of the longer side.
    pub long: Mat<f64>,
    /// Nodes of the shorter side by modes.
    pub short: Mat<f64>,
    /// The factors, modes of the longer side by modes of the shorter.
    pub table: Mat<f64>,
}

impl QuadraticForm {
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

    /// Takes the changes of a line's values into their modal form.
    fn take(&self, line: usize, changes: &[f64], modal: &mut Mat<f64>) {
        let along = self.long.col(line);
        for (b, column) in modal.col_iter_mut().enumerate() {
            let modes = self.short.col(b);
            let share: f64 = modes.iter().zip(changes).map(|(y, c)| y * c).sum();
            for (value, x) in column.iter_mut().zip(along.iter()) {
                *value += x * share;
            }
        }
    }

    /// The form's diagonal on the window.
    pub fn diagonal(&self) -> Mat<f64> {
        let squared = |m: &Mat<f64>| Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].powi(2));
        let half = product(self.table.as_ref(), squared(&self.short).transpose());
        product(squared(&self.long).transpose(), half.as_ref())
    }
}

/// Rows that one task computes; fixed, so that bits do not depend on the number of threads.
const ROWS: usize = 128;

/// left right, by tasks of some rows.
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

/// One pass over lines of the window: sets the candidates' forces to `wanted` of a node, its force
/// and its deflection, of which `others` is the part that is not of the modes.
///
/// The forces are in the modes of the plane, L = Qx^T F Qy. The deflection of one line, and what
/// the line's own forces change on it, are sums over the modes of the other axis; the line's change
/// of L is a product of a column and a row. So a pass costs as much as a product, and every node
/// meets the forces as they are then.
pub(crate) fn sweep_lines(
    window: &Window,
    forms: &[QuadraticForm],
    others: &[f64],
    force: &mut [f64],
    wanted: impl Fn(usize, f64, f64) -> f64,
) {
    let field = window.spread(force.iter().copied().enumerate());
    let mut loads: Vec<Mat<f64>> = forms.iter().map(|form| form.to_modes(&field)).collect();
    let [_, short] = window.shape();
    for (line, nodes) in window.lines.iter().enumerate() {
        if nodes.is_empty() {
            continue;
        }
        let mut deflection = vec![0.0; short];
        let mut own = Mat::<f64>::zeros(short, short);
        for (form, load) in forms.iter().zip(&loads) {
            let along = form.long.col(line);
            let count = form.short.ncols();
            let (mut here, mut weights) = (vec![0.0; count], vec![0.0; count]);
            for b in 0..count {
                let sums = (along.iter()).zip(form.table.col(b).iter().zip(load.col(b).iter()));
                for (x, (t, l)) in sums {
                    here[b] += x * t * l;
                    weights[b] += x * x * t;
                }
            }
            for (i, deflection) in deflection.iter_mut().enumerate() {
                let row = form.short.row(i);
                *deflection += row.iter().zip(&here).map(|(y, v)| y * v).sum::<f64>();
            }
            let weighted = Mat::from_fn(short, count, |i, b| form.short[(i, b)] * weights[b]);
            own += product(weighted.as_ref(), form.short.transpose());
        }
        let mut changes = vec![0.0; short];
        for &[place, number] in nodes {
            let moved = deflection[place] + others[number];
            let next = wanted(number, force[number], moved);
            let change = next - force[number];
            if change != 0.0 {
                force[number] = next;
                changes[place] = change;
                for (d, g) in deflection.iter_mut().zip(own.col(place).iter()) {
                    *d += change * g;
                }
            }
        }
        if changes.iter().any(|c| *c != 0.0) {
            for (form, load) in forms.iter().zip(&mut loads) {
                form.take(line, &changes, load);
            }
        }
    }
}
