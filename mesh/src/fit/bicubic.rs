//! A bicubic spline, and the heights that it goes through.

use crate::fit::b_spline::BSpline;

/// One height: place, value and weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Place along both axes [m].
    pub at: [f64; 2],
    /// Height [m].
    pub height: f64,
    /// Residuals count in proportion to this.
    pub weight: f64,
}

/// A bicubic spline over two axes.
#[derive(Clone, Debug)]
pub(crate) struct Bicubic {
    /// The splines along both axes.
    pub axes: [BSpline; 2],
    /// Coefficients, the second axis running fastest.
    pub coefficients: Vec<f64>,
}

impl Bicubic {
    /// Height at `at`.
    pub fn value(&self, at: [f64; 2]) -> f64 {
        let (i, along) = self.axes[0].values(at[0]);
        let (j, across) = self.axes[1].values(at[1]);
        let count = self.axes[1].count();
        let mut sum = 0.0;
        for (k, a) in along.iter().enumerate() {
            let row = &self.coefficients[(i + k) * count + j..][..4];
            sum += a
                * (row[0] * across[0]
                    + row[1] * across[1]
                    + row[2] * across[2]
                    + row[3] * across[3]);
        }
        sum
    }

    /// The mean of the surface and its mirror image along `axis`; the breaks must be symmetric.
    pub fn symmetrise(&mut self, axis: usize) {
        let [rows, columns] = [self.axes[0].count(), self.axes[1].count()];
        let old = self.coefficients.clone();
        for i in 0..rows {
            for j in 0..columns {
                let mirror = if axis == 0 {
                    (rows - 1 - i) * columns + j
                } else {
                    i * columns + columns - 1 - j
                };
                self.coefficients[i * columns + j] = 0.5 * (old[i * columns + j] + old[mirror]);
            }
        }
    }
}
