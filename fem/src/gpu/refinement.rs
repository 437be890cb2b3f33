//! Iterative refinement: a solve in double precision by corrections in single precision.

use crate::error::Error;
use crate::gpu::cg::DeviceCg;
use crate::gpu::device::open::Device;
use crate::precondition::planewise_diagonal::PlanewiseDiagonal;
use crate::tensor::operator::TensorOperator;

/// When a solve ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// ||b - K x|| <= tolerance ||b||.
    pub tolerance: f64,
    /// Iterations on the device, in all corrections together, after which [`Error::NotConverged`] is returned.
    pub max_iterations: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: 1e-10,
            max_iterations: 10_000,
        }
    }
}

/// How a solve went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Iterations on the device in all.
    pub iterations: usize,
    /// ||b - K x|| / ||b|| before the first and after each correction.
    pub residuals: Vec<f64>,
}

/// Solves K x = b: residuals by the operator in double precision, corrections by [`DeviceCg`].
///
/// r = b - K x, K d = r to single precision, x += d, and so on (J. H. Wilkinson, Rounding Errors in Algebraic Processes, 1963;
/// with an inexact inner solver N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, ch. 12;
/// E. Carson and N. J. Higham, SIAM J. Sci. Comput. 40 (2018), A817-A847, doi 10.1137/17M1140819). A correction is rounded to
/// some 6e-8 of itself; that error is of short waves, which the next correction finds again.
pub struct Solver<'a> {
    operator: &'a TensorOperator,
    cg: DeviceCg<'a>,
}

/// By how much one correction reduces the residual, where the tolerance does not ask for less.
const REDUCTION: f64 = 1e-4;

/// Iterations between looks at the device.
const STRETCH: usize = 4;

/// Corrections in a row that may fail to improve on the best residual.
const PATIENCE: usize = 3;

impl<'a> Solver<'a> {
    /// For one operator.
    ///
    /// # Errors
    /// As [`DeviceCg::new`].
    pub fn new(
        device: &'a Device,
        operator: &'a TensorOperator,
        planewise: &PlanewiseDiagonal,
    ) -> Result<Self, Error> {
        Ok(Solver {
            operator,
            cg: DeviceCg::new(device, operator, planewise)?,
        })
    }

    /// Solves from the start `x`, which may hold prescribed values on held entries.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where residuals stop falling above the tolerance, [`Error::Indefinite`] where K or P is not
    /// positive definite to single precision, [`Error::Device`].
    pub fn solve(&mut self, b: &[f64], x: &mut [f64], options: &Options) -> Result<History, Error> {
        assert_eq!(b.len(), x.len());
        let mut r = vec![0.0; b.len()];
        let mut history = History::default();
        let (mut best, mut failures) = (f64::INFINITY, 0);
        let b_norm = norm(b);
        let mut scale = b_norm;
        loop {
            self.operator.apply(x, &mut r);
            r.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
            let r_norm = norm(&r);
            if !r_norm.is_finite() {
                return Err(Error::Indefinite {
                    iteration: history.iterations,
                    energy: r_norm,
                });
            }
            if history.residuals.is_empty() && b_norm == 0.0 {
                // With b = 0 the start's own residual is the only scale there is.
                scale = r_norm;
            }
            let residual = if r_norm == 0.0 { 0.0 } else { r_norm / scale };
            history.residuals.push(residual);
            if residual <= options.tolerance {
                return Ok(history);
            }
            failures = if residual < best { 0 } else { failures + 1 };
            best = best.min(residual);
            if failures > PATIENCE || history.iterations >= options.max_iterations {
                return Err(Error::NotConverged {
                    iterations: history.iterations,
                    residual,
                    tolerance: options.tolerance,
                });
            }
            let reduction = (0.5 * options.tolerance / residual).max(REDUCTION);
            history.iterations +=
                self.correct(&r, reduction, options.max_iterations - history.iterations)?;
            self.cg.add_correction(x)?;
        }
    }

    /// One correction; returns its iterations.
    fn correct(&mut self, r: &[f64], reduction: f64, most: usize) -> Result<usize, Error> {
        self.cg.start(r, reduction);
        let mut before = 0;
        loop {
            self.cg.iterate(STRETCH);
            let progress = self.cg.progress()?;
            // Without a step the target is reached, or there is nothing to go by.
            if progress.alpha == 0.0 {
                if progress.iterations == 0 {
                    return Err(Error::Indefinite {
                        iteration: 0,
                        energy: f64::from(progress.energy),
                    });
                }
                return Ok(progress.iterations);
            }
            if !progress.residual.is_finite() {
                return Err(Error::Indefinite {
                    iteration: progress.iterations,
                    energy: f64::from(progress.energy),
                });
            }
            if progress.iterations >= most || progress.iterations == before {
                return Ok(progress.iterations);
            }
            before = progress.iterations;
        }
    }
}

fn norm(v: &[f64]) -> f64 {
    // Scaled, so that no square is too large or too small.
    let largest = v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let squares = v.iter().map(|v| (v / unit).powi(2));
    unit * squares.sum::<f64>().sqrt()
}
