//! Plain least squares of the magic formula by Levenberg-Marquardt.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn, U1, Vector3};

use crate::friction::error::Error;
use crate::friction::lateral::law::MagicFormula;
use crate::friction::lateral::score::{LateralSample, force_and_gradient, model_of, theta_of};

/// Least squares over the free parameters by Levenberg-Marquardt.
pub(crate) fn least_squares(
    samples: &[LateralSample],
    start: MagicFormula,
    free: [bool; 3],
) -> Result<MagicFormula, Error> {
    let problem = Residuals {
        samples,
        theta: theta_of(&start),
        free: (0..3).filter(|&i| free[i]).collect(),
        e: start.e,
    };
    // Looser than rounding: along a direction that the data do not determine the last digits cost most of the time, and the
    // corrected score takes the parameters further.
    let (problem, report) = LevenbergMarquardt::new()
        .with_ftol(1e-12)
        .with_xtol(1e-10)
        .minimize(problem);
    let model = model_of(&problem.theta, start.e);
    if !report.termination.was_successful() || model.check().is_err() {
        return Err(Error::NotConverged {
            what: "lateral fit, least squares",
            iterations: report.number_of_evaluations,
            residual: (2.0 * report.objective_function / samples.len() as f64).sqrt(),
            tolerance: f64::EPSILON,
        });
    }
    Ok(model)
}

struct Residuals<'a> {
    samples: &'a [LateralSample],
    theta: Vector3<f64>,
    free: Vec<usize>,
    e: f64,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Residuals<'_> {
    type ResidualStorage = Owned<f64, Dyn, U1>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn, U1>;

    fn set_params(&mut self, x: &DVector<f64>) {
        for (k, &i) in self.free.iter().enumerate() {
            self.theta[i] = x[k];
        }
    }

    fn params(&self) -> DVector<f64> {
        DVector::from_iterator(self.free.len(), self.free.iter().map(|&i| self.theta[i]))
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let model = model_of(&self.theta, self.e);
        let residual = |s: &LateralSample| model.force(s.alpha, s.fz) - s.fy;
        Some(DVector::from_iterator(
            self.samples.len(),
            self.samples.iter().map(residual),
        ))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let model = model_of(&self.theta, self.e);
        let mut jacobian = DMatrix::zeros(self.samples.len(), self.free.len());
        for (row, sample) in self.samples.iter().enumerate() {
            let (_, gradient) = force_and_gradient(&model, sample.alpha, sample.fz);
            for (k, &i) in self.free.iter().enumerate() {
                jacobian[(row, k)] = gradient[i];
            }
        }
        Some(jacobian)
    }
}
