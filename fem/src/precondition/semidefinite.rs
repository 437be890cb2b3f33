//! Cholesky factors of matrices whose rows may depend on each other.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::{Mat, Par};

use crate::error::Error;

/// A factor L L^T of S A S, with S = diag(A)^(-1/2), that leaves out unknowns which add nothing to those before them.
///
/// An unknown is left out where elimination leaves less than 1e-10 of its diagonal; it is 0 in every solution.
#[derive(Clone, Debug)]
pub(crate) struct SemidefiniteFactor {
    /// Lower triangle.
    lower: Mat<f64>,
    /// Diagonal of S; 0 where that of A is.
    scale: Vec<f64>,
}

/// Share of the diagonal below which a pivot is lost to rounding.
const LOST: f64 = 1e-10;
/// A pivot so large that its unknown becomes 0.
const OUT: f64 = 1e200;

impl SemidefiniteFactor {
    /// Of no unknowns.
    pub fn empty() -> Self {
        Self {
            lower: Mat::new(),
            scale: Vec::new(),
        }
    }

    /// Factorises a symmetric positive semi-definite matrix, of which the lower triangle is read.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] where an entry is no number.
    pub fn new(mut a: Mat<f64>) -> Result<Self, Error> {
        let n = a.nrows();
        let scale: Vec<f64> = (0..n)
            .map(|i| match a[(i, i)] {
                d if d > 0.0 => d.sqrt().recip(),
                _ => 0.0,
            })
            .collect();
        for j in 0..n {
            for i in j..n {
                a[(i, j)] *= scale[i] * scale[j];
            }
        }
        let request =
            llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default());
        let regularization = LltRegularization {
            dynamic_regularization_delta: OUT,
            dynamic_regularization_epsilon: LOST,
        };
        llt::factor::cholesky_in_place(
            a.as_mut(),
            regularization,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(request)),
            Default::default(),
        )
        .map_err(|_| Error::NotPositiveDefinite { free_dofs: n })?;
        Ok(Self { lower: a, scale })
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.scale.len()
    }

    /// `c` = A^-1 `c`, with 0 for unknowns left out.
    ///
    /// # Panics
    /// Where `c` has another length.
    pub fn solve(&self, c: &mut [f64]) {
        let scaled = |c: &mut [f64]| c.iter_mut().zip(&self.scale).for_each(|(c, s)| *c *= s);
        scaled(c);
        llt::solve::solve_in_place(
            self.lower.as_ref(),
            faer::MatMut::from_column_major_slice_mut(c, self.len(), 1),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(faer::dyn_stack::StackReq::EMPTY)),
        );
        scaled(c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknowns_that_add_nothing_are_left_out() {
        let a = [
            [2.0, 2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 9.0],
        ];
        let factor = SemidefiniteFactor::new(Mat::from_fn(4, 4, |i, j| a[i][j])).unwrap();
        let mut c = [4.0, 4.0, 3.0, 18.0];
        factor.solve(&mut c);
        for (found, expected) in c.iter().zip([2.0, 0.0, 0.0, 2.0]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn what_is_no_number_is_an_error() {
        let a = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { f64::NAN });
        assert!(SemidefiniteFactor::new(a).is_err());
    }
}
