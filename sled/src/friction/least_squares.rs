//! Nonlinear least squares by Levenberg and Marquardt.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, MinimizationReport};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

/// Minimises the sum of squared `residuals` from `start`; `residuals` and their `jacobian` are
/// functions of the parameters.
pub(crate) fn minimize(
    method: LevenbergMarquardt<f64>,
    start: DVector<f64>,
    residuals: impl Fn(&DVector<f64>) -> DVector<f64>,
    jacobian: impl Fn(&DVector<f64>) -> DMatrix<f64>,
) -> (DVector<f64>, MinimizationReport<f64>) {
    let (problem, report) = method.minimize(Problem {
        parameters: start,
        residuals,
        jacobian,
    });
    (problem.parameters, report)
}

struct Problem<R, J> {
    parameters: DVector<f64>,
    residuals: R,
    jacobian: J,
}

impl<R, J> LeastSquaresProblem<f64, Dyn, Dyn> for Problem<R, J>
where
    R: Fn(&DVector<f64>) -> DVector<f64>,
    J: Fn(&DVector<f64>) -> DMatrix<f64>,
{
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.parameters.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some((self.residuals)(&self.parameters))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some((self.jacobian)(&self.parameters))
    }
}
