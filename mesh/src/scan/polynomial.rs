//! Least squares of a polynomial in two places.

use nalgebra::{DMatrix, DVector};

/// A polynomial fitted to values at places: its coefficients with their standard errors, and the deviation of what is left.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// One a power.
    pub coefficients: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f64>,
    /// Standard deviation of the residuals.
    pub deviation: f64,
}

/// Fits the sum of c x^i y^j over `powers` [i, j] by least squares; `None` where the places do not determine it with ten values to
/// spare.
pub fn fit(places: &[[f64; 2]], values: &[f64], powers: &[[i32; 2]]) -> Option<Fitted> {
    let spare = values.len().checked_sub(powers.len())?;
    if spare < 10 {
        return None;
    }
    let mean = |axis: usize| places.iter().map(|p| p[axis]).sum::<f64>() / places.len() as f64;
    let centre = [mean(0), mean(1)];
    let scale = [0, 1].map(|axis| {
        let off = |p: &[f64; 2]| (p[axis] - centre[axis]).abs();
        let scale = places.iter().map(off).fold(0.0, f64::max);
        if scale > 0.0 { scale } else { 1.0 }
    });
    let term = |p: &[f64; 2], [i, j]: [i32; 2]| {
        let [u, v] = [0, 1].map(|axis| (p[axis] - centre[axis]) / scale[axis]);
        u.powi(i) * v.powi(j)
    };
    let design = DMatrix::from_fn(places.len(), powers.len(), |k, n| {
        term(&places[k], powers[n])
    });
    let values = DVector::from_column_slice(values);
    let normal = (design.transpose() * &design).cholesky()?;
    let coefficients = normal.solve(&(design.transpose() * &values));
    let left = (&design * &coefficients - values).norm_squared();
    let deviation = (left / spare as f64).sqrt();
    let inverse = normal.inverse();
    let unit = |n: usize| scale[0].powi(powers[n][0]) * scale[1].powi(powers[n][1]);
    let each = |of: &dyn Fn(usize) -> f64| (0..powers.len()).map(|n| of(n) / unit(n)).collect();
    Some(Fitted {
        coefficients: each(&|n| coefficients[n]),
        errors: each(&|n| deviation * inverse[(n, n)].sqrt()),
        deviation,
    })
}
