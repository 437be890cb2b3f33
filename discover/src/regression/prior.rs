//! Normal priors of fitted parameters.

use nalgebra::{DMatrix, DVector};

use crate::regression::inverse::ridge_inverse;

/// Independent normal priors of mean 0, in linear units; a precision of 0 is a flat prior.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Precision of each parameter.
    pub precision: DVector<f64>,
    /// Parameters at which the model is linearised.
    pub at: DVector<f64>,
    /// Number of parameters at the end with noise-free products and a precision above 0 (smooth
    /// terms).
    pub smooth: usize,
}

impl Prior {
    /// Flat priors.
    pub fn none(count: usize) -> Self {
        Self {
            precision: DVector::zeros(count),
            at: DVector::zeros(count),
            smooth: 0,
        }
    }

    /// Number of parameters.
    pub fn count(&self) -> usize {
        self.precision.len()
    }

    /// `inv(J'J + P)`.
    pub fn inverse(&self, mut products: DMatrix<f64>) -> DMatrix<f64> {
        for (k, precision) in self.precision.iter().enumerate() {
            products[(k, k)] += precision;
        }
        let first = self.count() - self.smooth;
        let smooth = products.view((first, first), (self.smooth, self.smooth));
        let Some(smooth) = smooth.into_owned().cholesky().filter(|_| self.smooth > 0) else {
            return ridge_inverse(products);
        };
        // Block inverse: with A, C and S the blocks of the other and the smooth parameters, the
        // first block of the inverse is the inverse of the Schur complement A - C inv(S) C'.
        let (smooth, cross) = (
            smooth.inverse(),
            products.view((0, first), (first, self.smooth)),
        );
        let shares = cross * &smooth;
        let schur = products.view((0, 0), (first, first)) - &shares * cross.transpose();
        let others = ridge_inverse(schur);
        let both = &others * &shares;
        let rest = smooth + shares.tr_mul(&both);
        let mut inverse = DMatrix::zeros(self.count(), self.count());
        inverse.view_mut((0, 0), (first, first)).copy_from(&others);
        let mut upper = inverse.view_mut((0, first), (first, self.smooth));
        upper.copy_from(&-&both);
        let mut lower = inverse.view_mut((first, 0), (self.smooth, first));
        lower.copy_from(&-both.transpose());
        let mut last = inverse.view_mut((first, first), (self.smooth, self.smooth));
        last.copy_from(&rest);
        inverse
    }

    /// Gradient of the log prior at these parameters, to be added to the scores `J'r`: `-P a`.
    pub fn scores(&self, at: &DVector<f64>) -> DVector<f64> {
        -self.precision.component_mul(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_by_blocks_are_those_of_the_whole() {
        let x = DMatrix::from_fn(40, 7, |i, k| (0.3 + 1.1 * (i * (k + 2)) as f64).sin());
        let mut prior = Prior::none(7);
        prior.precision.rows_mut(3, 4).fill(1.0);
        let whole = prior.inverse(x.tr_mul(&x));
        prior.smooth = 3;
        assert!((prior.inverse(x.tr_mul(&x)) - whole).amax() < 1e-12);
    }
}
