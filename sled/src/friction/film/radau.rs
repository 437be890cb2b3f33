//! One step of a Radau method for the film's equation.

use nalgebra::{Matrix3, Vector3};

/// The film's equation at one place: `dh/ds = alpha/h - beta - gamma h^3`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rate {
    /// Friction heat that melts.
    pub alpha: f64,
    /// Heat that is lost.
    pub beta: f64,
    /// Squeeze-out.
    pub gamma: f64,
}

impl Rate {
    fn value(&self, h: f64) -> f64 {
        self.alpha / h - self.beta - self.gamma * h.powi(3)
    }

    fn slope(&self, h: f64) -> f64 {
        -self.alpha / (h * h) - 3.0 * self.gamma * h * h
    }

    /// Root of one implicit Euler step, by bisection to a few per cent: where Newton's method may start.
    fn implicit_euler(&self, before: f64, step: f64) -> f64 {
        let mut low = 0.0;
        let mut high = before + (step * self.alpha).sqrt() + step * (-self.beta).max(0.0);
        for _ in 0..8 {
            let middle = 0.5 * (low + high);
            if middle - before - step * self.value(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Where the stages stand in the step, the last at its end.
pub(crate) fn nodes() -> [f64; 3] {
    let root = 6.0_f64.sqrt();
    [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0]
}

/// Weights of the stages in an integral over the step, exact for polynomials to the fourth degree.
pub(crate) fn weights() -> [f64; 3] {
    let root = 6.0_f64.sqrt();
    [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0]
}

fn stages() -> Matrix3<f64> {
    let root = 6.0_f64.sqrt();
    let last = weights();
    Matrix3::new(
        (88.0 - 7.0 * root) / 360.0,
        (296.0 - 169.0 * root) / 1800.0,
        (-2.0 + 3.0 * root) / 225.0,
        (296.0 + 169.0 * root) / 1800.0,
        (88.0 + 7.0 * root) / 360.0,
        (-2.0 - 3.0 * root) / 225.0,
        last[0],
        last[1],
        last[2],
    )
}

/// The three stages of one step of Radau IIA of order 5 from the thickness `before`, the last its end; `None` without convergence.
///
/// The method is stable for any stiffness and never asks for the rate at the beginning of the step, where the film's is without
/// bound at the leading edge; a thickness that grows linearly in `s` it meets exactly.
/// Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, section IV.5.
pub(crate) fn step(before: f64, step: f64, rates: &[Rate; 3]) -> Option<[f64; 3]> {
    let (nodes, stages) = (nodes(), stages());
    let mut h = Vector3::from_fn(|i, _| rates[i].implicit_euler(before, nodes[i] * step));
    for _ in 0..40 {
        let value = Vector3::from_fn(|i, _| rates[i].value(h[i]));
        let residual = h - Vector3::repeat(before) - step * stages * value;
        let slope = Vector3::from_fn(|i, _| rates[i].slope(h[i]));
        let jacobian = Matrix3::identity() - step * stages * Matrix3::from_diagonal(&slope);
        let correction = jacobian.lu().solve(&residual)?;
        let mut largest = 0.0_f64;
        for i in 0..3 {
            let next = (h[i] - correction[i]).max(0.2 * h[i]);
            largest = largest.max((next / h[i] - 1.0).abs());
            h[i] = next;
        }
        if !largest.is_finite() {
            return None;
        }
        if largest < 1e-9 {
            return Some([h[0], h[1], h[2]]);
        }
    }
    None
}
