//! Time derivative of a sampled signal by local polynomials.

use std::sync::LazyLock;

use nalgebra::{DMatrix, DVector};

/// Samples on each side of the one whose slope is taken.
pub const HALF_WIDTH: usize = 3;
/// Degree of the local polynomial.
pub const DEGREE: usize = 4;

const WIDTH: usize = 2 * HALF_WIDTH + 1;

/// Weights for the slope at each place of a window of seven samples.
static WEIGHTS: LazyLock<[[f64; WIDTH]; WIDTH]> = LazyLock::new(|| {
    let powers = |x: f64| DVector::from_fn(DEGREE + 1, |k, _| x.powi(k as i32));
    let abscissa = |i: usize| i as f64 - HALF_WIDTH as f64;
    let design = DMatrix::from_fn(WIDTH, DEGREE + 1, |i, k| abscissa(i).powi(k as i32));
    // Seven abscissae determine a quartic: the normal matrix is regular.
    let solve = (design.transpose() * &design)
        .try_inverse()
        .expect("seven points determine a quartic")
        * design.transpose();
    let mut weights = [[0.0; WIDTH]; WIDTH];
    for (place, row) in weights.iter_mut().enumerate() {
        let x = abscissa(place);
        let slope = DVector::from_fn(DEGREE + 1, |k, _| {
            if k == 0 {
                0.0
            } else {
                k as f64 * powers(x)[k - 1]
            }
        });
        for (i, weight) in row.iter_mut().enumerate() {
            *weight = solve.column(i).dot(&slope);
        }
    }
    weights
});

/// Derivative of a uniformly sampled signal: a quartic through seven samples by least squares (Savitzky and Golay).
///
/// ```text
/// y'_i = ( 22 (y_{i-3} - y_{i+3}) - 67 (y_{i-2} - y_{i+2}) - 58 (y_{i-1} - y_{i+1}) ) / (252 dt)
/// ```
///
/// Exact for polynomials up to degree 4; white noise of deviation sd comes out with 0.51 sd / dt. The three samples at
/// each end take the slope of the first or last window's quartic. Unit: that of `values` per second.
///
/// Source: A. Savitzky, M. Golay, Anal. Chem. 36 (1964) 1627, table of quartic first derivatives.
///
/// # Panics
/// Where there are fewer than seven samples.
pub fn derivative(values: &[f64], dt_s: f64) -> Vec<f64> {
    assert!(
        values.len() >= WIDTH,
        "a derivative needs {WIDTH} samples, got {}",
        values.len()
    );
    let last_start = values.len() - WIDTH;
    (0..values.len())
        .map(|i| {
            let start = i.saturating_sub(HALF_WIDTH).min(last_start);
            let weights = &WEIGHTS[i - start];
            let slope: f64 = weights
                .iter()
                .zip(&values[start..start + WIDTH])
                .map(|(weight, value)| weight * value)
                .sum();
            slope / dt_s
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartics_are_differentiated_exactly_up_to_the_ends() {
        let dt = 0.01;
        let f = |t: f64| 1.0 + t * (2.0 - t * (3.0 - t * (4.0 - 5.0 * t)));
        let slope = |t: f64| 2.0 - 6.0 * t + 12.0 * t * t - 20.0 * t * t * t;
        let values: Vec<f64> = (0..40).map(|i| f(i as f64 * dt)).collect();
        for (i, d) in derivative(&values, dt).iter().enumerate() {
            let expected = slope(i as f64 * dt);
            assert!((d - expected).abs() < 1e-10, "{i}: {d} against {expected}");
        }
    }

    #[test]
    fn weights_are_those_of_the_published_table() {
        let table = [22.0, -67.0, -58.0, 0.0, 58.0, 67.0, -22.0];
        for (weight, published) in WEIGHTS[HALF_WIDTH].iter().zip(table) {
            assert!((weight - published / 252.0).abs() < 1e-13);
        }
        let gain: f64 = WEIGHTS[HALF_WIDTH]
            .iter()
            .map(|w| w * w)
            .sum::<f64>()
            .sqrt();
        assert!((gain - 0.5124).abs() < 1e-3, "noise gain {gain}");
    }
}
