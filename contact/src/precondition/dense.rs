//! Dense Cholesky factors in an order of operations that does not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::solve::{solve_in_place, solve_in_place_scratch};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::linalg::solvers::Llt;
use faer::perm::Perm;
use faer::{Mat, MatRef, Par, Side};

/// Cholesky factor of a dense symmetric matrix, A = L L^T.
#[derive(Clone, Debug)]
pub(crate) struct DenseCholesky(Llt<f64>);

impl DenseCholesky {
    /// Factorises a symmetric matrix given by its lower half; `None` if it is not positive
    /// definite.
    ///
    /// Runs on all threads; each block of the factor is summed by one thread.
    pub fn new(matrix: &Mat<f64>) -> Option<Self> {
        Llt::new(matrix.as_ref(), Side::Lower)
            .ok()
            .map(DenseCholesky)
    }

    /// L, with zeros above its diagonal.
    pub fn lower(&self) -> MatRef<'_, f64> {
        self.0.L()
    }

    /// A^-1 `sides`, on one thread: several threads would divide the sum of one row.
    pub fn solve(&self, sides: &Mat<f64>) -> Mat<f64> {
        let mut solved = sides.clone();
        let n = self.lower().nrows();
        let request = solve_in_place_scratch::<f64>(n, sides.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(request);
        let stack = MemStack::new(&mut memory);
        solve_in_place(self.lower(), solved.as_mut(), Par::Seq, stack);
        solved
    }
}

// Dense LU factors in an order of operations that does not depend on the number of threads.

/// P A = L U with partial pivoting.
pub(crate) struct DenseLu {
    /// L below the diagonal (its diagonal is 1), U on and above it.
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

    /// From the smallest sizes on which faer would share a product among threads.
    #[test]
    fn factors_and_solutions_have_the_same_bits_on_any_number_of_threads_and_are_such() {
        for n in [30, 300, 900] {
            let a = Mat::from_fn(n, n, |i, j| (1.0 + i.abs_diff(j) as f64).recip());
            for columns in [1, 3, 4] {
                let sides = Mat::from_fn(n, columns, |i, j| (0.37 * i as f64 + j as f64).sin());
                let on = |threads: usize| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                    let pool = pool.build().unwrap();
                    pool.install(|| {
                        let factor = DenseCholesky::new(&a).unwrap();
                        (factor.lower().to_owned(), factor.solve(&sides))
                    })
                };
                let one = on(1);
                for threads in [2, 3] {
                    assert!(
                        one == on(threads),
                        "{n} x {n}, {columns} sides, {threads} threads"
                    );
                }
                let residual = &a * &one.1 - &sides;
                assert!(residual.norm_max() < 1e-12);
            }
        }
        assert!(
            DenseCholesky::new(&Mat::from_fn(3, 3, |i, j| -f64::from(u8::from(i == j)))).is_none()
        );
    }
}

#[cfg(test)]
mod dense_lu_tests {
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
