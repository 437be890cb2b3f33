//! The rectangle of the contact plane that the candidates lie in, and products over it.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

/// The smallest rectangle of plane nodes around the candidates; its longer side is counted first.
pub(crate) struct Window {
    /// First node and number of nodes, along x and along y.
    pub along: [std::ops::Range<usize>; 2],
    /// The axes of its longer and of its shorter side.
    pub axes: [usize; 2],
    /// Where each candidate stands, longer side first.
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
        let axes = match along[0].len() >= along[1].len() {
            true => [0, 1],
            false => [1, 0],
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

/// A quadratic form in the modes of both axes: values on the window, modal form, a factor for each pair of modes, and back.
pub(crate) struct Form {
    /// Modes by nodes of the longer side.
    pub long: Mat<f64>,
    /// Nodes of the shorter side by modes.
    pub short: Mat<f64>,
    /// The factors, modes of the longer side by modes of the shorter.
    pub table: Mat<f64>,
}

impl Form {
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
