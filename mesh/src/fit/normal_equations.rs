//! The normal equations of a bicubic spline, and their solution by sparse Cholesky factorisation.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Splines along an axis that overlap a given one on either side of it.
const REACH: usize = 3;

/// Symmetric equations in the coefficients of a bicubic spline, the second axis running fastest.
///
/// Coefficient (i, j) meets (k, l) where |i - k| and |j - l| are at most 3. The lower triangle is kept column by column.
pub(crate) struct NormalEquations {
    columns: usize,
    starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
    right: Vec<f64>,
}

impl NormalEquations {
    /// Zero equations in `rows` times `columns` coefficients, at least four each way.
    pub fn new(rows: usize, columns: usize) -> Self {
        let mut equations = Self {
            columns,
            starts: vec![0],
            rows: Vec::new(),
            values: Vec::new(),
            right: vec![0.0; rows * columns],
        };
        for i in 0..rows {
            for j in 0..columns {
                for k in i..rows.min(i + REACH + 1) {
                    let first = if k == i { j } else { j.saturating_sub(REACH) };
                    let last = columns.min(j + REACH + 1);
                    let below = (first..last).map(|l| (k * columns + l) as u32);
                    equations.rows.extend(below);
                }
                equations.starts.push(equations.rows.len() as u32);
            }
        }
        equations.values = vec![0.0; equations.rows.len()];
        equations
    }

    /// Adds `weight (a . s - height)^2` for the coefficients s of the four by four splines from (`i`, `j`) on, the
    /// factors `a` being products of `along` and `across`.
    pub fn add(
        &mut self,
        [i, j]: [usize; 2],
        [along, across]: [&[f64; 4]; 2],
        weight: f64,
        height: f64,
    ) {
        let factors: [f64; 16] = std::array::from_fn(|k| along[k / 4] * across[k % 4]);
        let weighted = factors.map(|factor| weight * factor);
        for (n, &factor) in factors.iter().enumerate() {
            let (own, place) = (n / 4, j + n % 4);
            let column = (i + own) * self.columns + place;
            self.right[column] += weighted[n] * height;
            let from = self.starts[column] as usize;
            let mut add = |at: usize, others: &[f64]| {
                let entries = &mut self.values[at..at + others.len()];
                for (entry, other) in entries.iter_mut().zip(others) {
                    *entry += other * factor;
                }
            };
            add(from, &weighted[n..4 * own + 4]);
            // Entries of the column in its own row of coefficients, and in each row after that.
            let end = self.columns.min(place + REACH + 1);
            let low = place.saturating_sub(REACH);
            let mut at = from + (end - place) + (j - low);
            for others in weighted.chunks_exact(4).skip(own + 1) {
                add(at, others);
                at += end - low;
            }
        }
    }

    /// Factorises the matrix; none where it determines no coefficients.
    pub fn factored(self) -> Option<Factored> {
        let size = self.right.len();
        let lower =
            SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.rows);
        let symbolic = factorize_symbolic_cholesky(
            lower,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let mut factor = vec![0.0; symbolic.len_val()];
        // One thread, so that the bits stay the same on any machine's number of them.
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(lower, &self.values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::try_new(request).ok()?),
                Default::default(),
            )
            .ok()?;
        Some(Factored {
            columns: self.columns,
            symbolic,
            factor,
            right: self.right,
        })
    }

    /// The coefficients; none where they are not determined.
    pub fn solve(self) -> Option<Vec<f64>> {
        let mut factored = self.factored()?;
        let right = std::mem::take(&mut factored.right);
        factored.solve(right)
    }
}

/// Equations whose matrix is factorised: they are solved again for other heights at the same places.
pub(crate) struct Factored {
    columns: usize,
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
    /// The right-hand side that they came with.
    right: Vec<f64>,
}

impl Factored {
    /// Number of coefficients.
    pub fn size(&self) -> usize {
        self.right.len()
    }

    /// Adds to a right-hand side what [`NormalEquations::add`] adds to its own.
    pub fn add_right(
        &self,
        right: &mut [f64],
        [i, j]: [usize; 2],
        [along, across]: [&[f64; 4]; 2],
        weighted: f64,
    ) {
        for (k, a) in along.iter().enumerate() {
            let row = &mut right[(i + k) * self.columns + j..][..4];
            for (entry, b) in row.iter_mut().zip(across) {
                *entry += weighted * a * b;
            }
        }
    }

    /// The coefficients of a right-hand side; none where they are not determined.
    pub fn solve(&self, mut right: Vec<f64>) -> Option<Vec<f64>> {
        let size = right.len();
        let request = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut right, size, 1),
            Par::Seq,
            MemStack::new(&mut MemBuffer::try_new(request).ok()?),
        );
        let determined = right.iter().all(|value| value.is_finite());
        determined.then_some(right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations of many overlapping blocks, and the same as a full matrix.
    fn both(rows: usize, columns: usize) -> (NormalEquations, Vec<Vec<f64>>) {
        let size = rows * columns;
        let mut equations = NormalEquations::new(rows, columns);
        let mut full = vec![vec![0.0; size]; size];
        for block in 0..4 * size {
            let (i, j) = (block % (rows - 3), (block / (rows - 3)) % (columns - 3));
            let numbers = |seed: usize| [0, 1, 2, 3].map(|k| ((seed * 4 + k).pow(2) as f64).sin());
            let (along, across) = (numbers(block), numbers(block + 7919));
            let (weight, height) = (1.0 + (block % 3) as f64, (block as f64).cos());
            equations.add([i, j], [&along, &across], weight, height);
            let place = |k: usize| (i + k / 4) * columns + j + k % 4;
            for k in 0..16 {
                for l in 0..16 {
                    full[place(k)][place(l)] +=
                        weight * along[k / 4] * across[k % 4] * along[l / 4] * across[l % 4];
                }
            }
        }
        (equations, full)
    }

    #[test]
    fn the_solution_satisfies_the_equations() {
        for [rows, columns] in [[4, 4], [5, 9], [11, 6]] {
            let (equations, full) = both(rows, columns);
            let right = equations.right.clone();
            let solution = equations.solve().unwrap();
            let scale = solution.iter().fold(1.0f64, |m, v| m.max(v.abs()));
            for (row, wanted) in full.iter().zip(&right) {
                let found: f64 = row.iter().zip(&solution).map(|(a, s)| a * s).sum();
                assert!((found - wanted).abs() < 1e-11 * scale, "{found} {wanted}");
            }
        }
    }

    #[test]
    fn coefficients_that_nothing_determines_are_refused() {
        let mut equations = NormalEquations::new(5, 4);
        equations.add([0, 0], [&[1.0; 4], &[1.0; 4]], 1.0, 1.0);
        assert!(equations.solve().is_none());
        let (mut equations, _) = both(5, 5);
        equations.values[0] = f64::NAN;
        assert!(equations.solve().is_none());
    }
}
