//! What is known of fitted parameters before the data are.

use nalgebra::{DMatrix, DVector};

use crate::regression::inverse::ridge_inverse;

/// Independent normal laws about 0, in units in which the fit is linear; a precision of 0: nothing is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Precision of each parameter.
    pub precision: DVector<f64>,
    /// Parameters of the model that is differentiated.
    pub at: DVector<f64>,
}

impl Prior {
    /// Nothing known of so many parameters.
    pub fn none(count: usize) -> Self {
        Self {
            precision: DVector::zeros(count),
            at: DVector::zeros(count),
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
        ridge_inverse(products)
    }

    /// What is added to the scores `J'r` at these parameters: `-P a`.
    pub fn scores(&self, at: &DVector<f64>) -> DVector<f64> {
        -self.precision.component_mul(at)
    }
}
