//! Dense Cholesky factors in an order of operations that does not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::{factor, solve};
use faer::{Mat, MatRef, Par};

/// A = L L^T.
#[derive(Debug)]
pub(crate) struct DenseCholesky {
    /// L on and below the diagonal; what stands above is not its own.
    lower: Mat<f64>,
}

impl DenseCholesky {
    /// Factorises a symmetric matrix, of which the lower half is read; `None` where it is not positive definite.
    pub fn new(mut matrix: Mat<f64>) -> Option<Self> {
        let n = matrix.nrows();
        let request = factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(request);
        factor::cholesky_in_place(
            matrix.as_mut(),
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .ok()?;
        Some(DenseCholesky { lower: matrix })
    }

    /// L; only its lower half may be read.
    pub fn lower(&self) -> MatRef<'_, f64> {
        self.lower.as_ref()
    }

    /// A^-1 `side`.
    pub fn solve(&self, side: &Mat<f64>) -> Mat<f64> {
        let mut solved = side.clone();
        let n = self.lower.nrows();
        let request = solve::solve_in_place_scratch::<f64>(n, side.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(request);
        solve::solve_in_place(
            self.lower.as_ref(),
            solved.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        solved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve_what_they_are_of_and_no_other_matrix_has_any() {
        let matrix = Mat::from_fn(90, 90, |i, j| {
            1.0 / (1.0 + i.abs_diff(j) as f64) + if i == j { 3.0 } else { 0.0 }
        });
        let expected = Mat::from_fn(90, 3, |i, j| (i as f64 - 2.0 * j as f64).sin());
        let side = &matrix * &expected;
        let factors = DenseCholesky::new(matrix).unwrap();
        assert!((factors.solve(&side) - expected).norm_max() < 1e-13);
        assert!(DenseCholesky::new(faer::mat![[1.0, 2.0], [2.0, 1.0]]).is_none());
    }
}
