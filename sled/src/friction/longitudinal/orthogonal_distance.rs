//! Quadratic through points with errors in both coordinates, and without weights.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn, Matrix3, U1, Vector3};

use crate::friction::error::Error;
use crate::friction::longitudinal::mu_fit::{MuFit, Weighting};
use crate::friction::tables::experiments::Experiment;

/// Points in a scaled pressure `t = (p - centre)/width`, for conditioning.
pub(crate) struct Points {
    t: DVector<f64>,
    t_sd: DVector<f64>,
    mu: DVector<f64>,
    mu_sd: DVector<f64>,
    centre: f64,
    width: f64,
}

impl Points {
    pub(crate) fn new(experiments: &[Experiment]) -> Self {
        let column = |value: fn(&Experiment) -> f64| {
            DVector::from_iterator(experiments.len(), experiments.iter().map(value))
        };
        let p = column(|e| e.p_max_pa * 1e-6);
        let centre = p.mean();
        let width = p.map(|p| (p - centre).abs()).max().max(f64::MIN_POSITIVE);
        Points {
            t: p.map(|p| (p - centre) / width),
            t_sd: column(|e| e.p_max_sd_pa * 1e-6) / width,
            mu: column(|e| e.mu * 1e3),
            mu_sd: column(|e| e.mu_sd * 1e3),
            centre,
            width,
        }
    }

    /// Unweighted coefficients of (t^2, t, 1) and the inverse of the normal matrix.
    pub(crate) fn plain(&self) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        let design = DMatrix::from_fn(self.t.len(), 3, |i, j| self.t[i].powi(2 - j as i32));
        let singular = design.singular_values();
        let ratio = singular.min() / singular.max();
        let normal = design.transpose() * &design;
        let normal = Matrix3::from_fn(|i, j| normal[(i, j)]);
        match normal.try_inverse() {
            Some(inverse) if ratio > 1e-6 => {
                let right = design.transpose() * &self.mu;
                Ok((
                    inverse * Vector3::new(right[0], right[1], right[2]),
                    inverse,
                ))
            }
            _ => Err(Error::Undetermined {
                what: "a quadratic in the pressure (three different pressures are needed)",
                ratio: if ratio.is_finite() { ratio } else { 0.0 },
            }),
        }
    }

    pub(crate) fn squares(&self, coefficients: &Vector3<f64>) -> f64 {
        self.t
            .iter()
            .zip(&self.mu)
            .map(|(t, mu)| (mu - quadratic(coefficients, *t)).powi(2))
            .sum()
    }

    pub(crate) fn orthogonal(
        &self,
        start: Vector3<f64>,
    ) -> Result<(Vector3<f64>, Matrix3<f64>, f64), Error> {
        let n = self.t.len();
        let mut unknowns = DVector::zeros(3 + n);
        unknowns.rows_mut(0, 3).copy_from(&start);
        let problem = Orthogonal {
            points: self,
            unknowns,
        };
        let (problem, report) = LevenbergMarquardt::new().minimize(problem);
        let chi2 = 2.0 * report.objective_function;
        let not_converged = Error::NotConverged {
            what: "mu(p) fit",
            iterations: report.number_of_evaluations,
            residual: chi2,
            tolerance: f64::EPSILON,
        };
        if !report.termination.was_successful() {
            return Err(not_converged);
        }
        let Some(jacobian) = problem.jacobian() else {
            return Err(not_converged);
        };
        let Some(inverse) = (jacobian.transpose() * &jacobian).try_inverse() else {
            return Err(not_converged);
        };
        let u = &problem.unknowns;
        Ok((
            Vector3::new(u[0], u[1], u[2]),
            Matrix3::from_fn(|i, j| inverse[(i, j)]),
            chi2,
        ))
    }

    /// From (t^2, t, 1) back to b, c, d.
    pub(crate) fn result(
        &self,
        coefficients: Vector3<f64>,
        covariance: Matrix3<f64>,
        weighting: Weighting,
        chi2: f64,
        p_value: Option<f64>,
        (confidence, quantile): (f64, f64),
    ) -> MuFit {
        let (m, w) = (self.centre, self.width);
        let back = Matrix3::new(
            1.0 / (w * w),
            0.0,
            0.0,
            2.0 * m / (w * w),
            -1.0 / w,
            0.0,
            m * m / (w * w),
            -m / w,
            1.0,
        );
        let bcd = back * coefficients;
        MuFit {
            b: bcd[0],
            c: bcd[1],
            d: bcd[2],
            covariance: back * covariance * back.transpose(),
            weighting,
            chi2,
            freedom: self.t.len() - 3,
            p_value,
            confidence,
            quantile,
        }
    }
}

fn quadratic(coefficients: &Vector3<f64>, t: f64) -> f64 {
    (coefficients[0] * t + coefficients[1]) * t + coefficients[2]
}

/// Unknowns: the three coefficients, then for each point its shift along t in standard deviations.
struct Orthogonal<'a> {
    points: &'a Points,
    unknowns: DVector<f64>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Orthogonal<'_> {
    type ResidualStorage = Owned<f64, Dyn, U1>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn, U1>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.unknowns.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.unknowns.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let n = self.points.t.len();
        let u = &self.unknowns;
        let coefficients = Vector3::new(u[0], u[1], u[2]);
        Some(DVector::from_fn(2 * n, |row, _| {
            if row >= n {
                return u[3 + row - n];
            }
            let t = self.points.t[row] + u[3 + row] * self.points.t_sd[row];
            (quadratic(&coefficients, t) - self.points.mu[row]) / self.points.mu_sd[row]
        }))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let n = self.points.t.len();
        let u = &self.unknowns;
        let mut jacobian = DMatrix::zeros(2 * n, 3 + n);
        for i in 0..n {
            let (t_sd, mu_sd) = (self.points.t_sd[i], self.points.mu_sd[i]);
            let t = self.points.t[i] + u[3 + i] * t_sd;
            jacobian[(i, 0)] = t * t / mu_sd;
            jacobian[(i, 1)] = t / mu_sd;
            jacobian[(i, 2)] = 1.0 / mu_sd;
            jacobian[(i, 3 + i)] = (2.0 * u[0] * t + u[1]) * t_sd / mu_sd;
            jacobian[(n + i, 3 + i)] = 1.0;
        }
        Some(jacobian)
    }
}
