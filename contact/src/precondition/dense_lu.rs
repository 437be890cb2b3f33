//! Dense LU factors in an order of operations that does not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::Perm;
use faer::{Mat, Par};

/// P A = L U with partial pivoting.
pub(crate) struct DenseLu {
    /// L below the diagonal, without its ones, U on it and above.
    factors: Mat<f64>,
    rows: Perm<usize>,
}

impl DenseLu {
    /// Factorises a square matrix; a singular one gives solutions that are not finite.
    pub fn new(mut matrix: Mat<f64>) -> Self {
        let n = matrix.nrows();
        let (mut forward, mut backward) = (vec![0; n], vec![0; n]);
        let request = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(request);
        factor::lu_in_place(
            matrix.as_mut(),
            &mut forward,
            &mut backward,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        DenseLu {
            factors: matrix,
            rows: Perm::new_checked(forward.into(), backward.into(), n),
        }
    }

    /// Solves A X = `side` in place.
    pub fn solve_in_place(&self, side: &mut Mat<f64>) {
        let n = self.factors.nrows();
        let request = solve::solve_in_place_scratch::<usize, f64>(n, side.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(request);
        solve::solve_in_place(
            self.factors.as_ref(),
            self.factors.as_ref(),
            self.rows.as_ref(),
            side.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve_what_they_are_of() {
        let matrix = Mat::from_fn(7, 7, |i, j| {
            // Large off the diagonal, so that rows have to change places.
            ((3 * i + 5 * j) % 7) as f64 + if (i + 3) % 7 == j { 40.0 } else { 0.0 }
        });
        let expected = Mat::from_fn(7, 2, |i, j| i as f64 - 2.0 * j as f64);
        let mut side = &matrix * &expected;
        DenseLu::new(matrix).solve_in_place(&mut side);
        for j in 0..2 {
            for i in 0..7 {
                assert!((side[(i, j)] - expected[(i, j)]).abs() < 1e-11);
            }
        }
    }
}
