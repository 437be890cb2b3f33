//! Quadratic fit of the coefficient of friction over the peak pressure.
//!
//! Units inside the fit are those of the formula: p in MPa, mu in 1e-3, so that the coefficients
//! compare with the published ones.

use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use crate::error::{Error, in_range};
use crate::friction::estimate::{Estimate, student_quantile};
use crate::friction::experiments::Experiment;
use crate::friction::least_squares::minimize;
use crate::friction::longitudinal::law::{PressureLaw, ZetaActsOn};

/// Smallest standard deviation of a coefficient of friction in a weighted fit.
const MIN_SD: f64 = 1e-20;
/// Largest number of Newton steps for the true pressure of a point.
const MAX_PRESSURE_STEPS: usize = 50;
/// Last of these steps, relative to the standard deviation of the pressure: Newton's steps square
/// the error.
const PRESSURE_STEP: f64 = 1e-9;

/// Fits the quadratic to experiments.
///
/// Rows of one specimen at one pressure are averaged to one point, since they share one error of
/// the pressure.
///
/// `Weighting::Both` minimises `sum ((mu_i - q(xi_i))/s_mu)^2 + ((p_i - xi_i)/s_p)^2` over the
/// coefficients and the true pressures `xi_i` (P. Boggs and J. Rogers, "Orthogonal distance
/// regression", 1990); the covariance is the coefficients' block of `(J^T J)^-1` with the stated
/// errors.
///
/// # Errors
/// [`Error::TooFew`] below four points, [`Error::OutOfRange`] if no coefficient is positive,
/// [`Error::File`] for `mu_sd` below 1e-20 in a weighted fit, [`Error::Undetermined`] below three
/// different pressures, [`Error::NotConverged`].
pub fn fit_mu(
    experiments: &[Experiment],
    weighting: Weighting,
    confidence: f64,
) -> Result<MuFit, Error> {
    let exact = experiments.iter().position(|e| e.mu_sd < MIN_SD);
    if let (Some(i), Weighting::Both) = (exact, weighting) {
        let (name, mu_sd) = (&experiments[i].specimen, experiments[i].mu_sd);
        let reason = format!("mu_sd = {mu_sd}: expected at least {MIN_SD:e} in a weighted fit");
        let place = format!("experiment {} ({name})", i + 1);
        return Err(Error::file(place, reason));
    }
    let experiments = &combined(experiments)[..];
    if experiments.len() < 4 {
        let what = "mu(p) fit: different specimens or pressures";
        return Err(Error::too_few(what, experiments.len(), 4));
    }
    let largest = experiments.iter().map(|e| e.mu).fold(f64::MIN, f64::max);
    let expected = "above 0 in one experiment at least";
    in_range("largest mu", largest, largest > 0.0, expected)?;
    let points = Points::new(experiments);
    let freedom = experiments.len() - 3;
    let plain = points.plain()?;
    if weighting == Weighting::None {
        let quantile = student_quantile(confidence, freedom);
        return Ok(points.result(&plain, weighting, confidence, quantile));
    }
    let weighted = points.orthogonal(plain.coefficients)?;
    let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * confidence);
    let distribution = ChiSquared::new(freedom as f64).ok();
    Ok(MuFit {
        p_value: distribution.map(|d| d.sf(weighted.chi2)),
        ..points.result(&weighted, weighting, confidence, quantile)
    })
}

/// The mean of all rows of each specimen at each pressure, in order of first appearance.
fn combined(experiments: &[Experiment]) -> Vec<Experiment> {
    let mut groups: Vec<Vec<&Experiment>> = Vec::new();
    for one in experiments {
        let is_same = |group: &&mut Vec<&Experiment>| {
            group[0].specimen == one.specimen && group[0].p_max_pa == one.p_max_pa
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    let mean = |group: &Vec<&Experiment>| {
        let mean = |value: fn(&Experiment) -> f64| {
            group.iter().map(|one| value(one)).sum::<f64>() / group.len() as f64
        };
        Experiment {
            p_max_sd_pa: mean(|one| one.p_max_sd_pa),
            mu: mean(|one| one.mu),
            mu_sd: (mean(|one| one.mu_sd.powi(2)) / group.len() as f64).sqrt(),
            ..group[0].clone()
        }
    };
    groups.iter().map(mean).collect()
}

/// How the points are weighted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Weighting {
    /// By the stated errors of both mu and p: orthogonal distance regression.
    #[default]
    Both,
    /// Equal weights, errors from the scatter, as in the paper.
    None,
}

/// A fitted quadratic `mu = 1e-3 (b p^2 - c p + d)`.
#[derive(Clone, Debug, PartialEq)]
pub struct MuFit {
    /// Quadratic coefficient [1e-3/MPa2].
    pub b: f64,
    /// Linear coefficient, entering with a minus sign [1e-3/MPa].
    pub c: f64,
    /// Constant [1e-3].
    pub d: f64,
    /// Covariance of (b, c, d).
    pub covariance: Matrix3<f64>,
    /// How the points were weighted.
    pub weighting: Weighting,
    /// Weighted sum of squared residuals in mu and p; of an unweighted fit the sum of squares in mu
    /// [1e-6].
    pub chi2: f64,
    /// Degrees of freedom: points minus parameters.
    pub freedom: usize,
    /// Probability of a larger chi2 if curve and errors are right; `None` without weights or
    /// degrees of freedom.
    pub p_value: Option<f64>,
    /// Confidence level of intervals and band.
    pub confidence: f64,
    /// Two-sided quantile of the intervals: normal for stated errors, Student's t for errors from
    /// the scatter.
    pub quantile: f64,
}

/// Pressure of the least friction, and the coefficient there.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LeastFriction {
    /// Pressure [Pa], interval by Fieller's theorem.
    pub p_pa: Estimate,
    /// Coefficient there.
    pub mu: Estimate,
}

impl MuFit {
    /// The law with cap and asperity factor.
    pub fn law(&self, mu_cap: f64, zeta: f64, zeta_acts_on: ZetaActsOn) -> PressureLaw {
        PressureLaw {
            b: self.b,
            c: self.c,
            d: self.d,
            mu_cap,
            zeta,
            zeta_acts_on,
        }
    }

    /// The fitted coefficient at `p_pa` [Pa] with its confidence interval, before any cap.
    ///
    /// The interval is that of the mean response of a least-squares fit, symmetric and not cut at 0
    /// (as `get_prediction().conf_int()` of statsmodels): an end below 0 shows that the data do not
    /// determine mu there.
    pub fn band(&self, p_pa: f64) -> Estimate {
        let p = p_pa * 1e-6;
        let gradient = Vector3::new(p * p, -p, 1.0);
        let value = gradient.dot(&Vector3::new(self.b, self.c, self.d));
        let variance = gradient.dot(&(self.covariance * gradient)).max(0.0);
        let half = self.quantile * variance.sqrt();
        let [value, low, high] = [value, value - half, value + half].map(|mu| 1e-3 * mu);
        Estimate { value, low, high }
    }

    /// The minimum of the curve; `None` if a straight line or a maximum is within the errors.
    ///
    /// The interval contains every p with `(2 b p - c)^2 <= q^2 var(2 b p - c)` (Fieller).
    pub fn least_friction(&self) -> Option<LeastFriction> {
        let (v, q2) = (&self.covariance, self.quantile * self.quantile);
        let square = 4.0 * (self.b * self.b - q2 * v[(0, 0)]);
        let linear = 4.0 * (self.b * self.c - q2 * v[(0, 1)]);
        let constant = self.c * self.c - q2 * v[(1, 1)];
        let root = linear * linear - 4.0 * square * constant;
        if self.b <= 0.0 || square <= 0.0 || root < 0.0 {
            return None;
        }
        let at = |sign: f64| 1e6 * (linear + sign * root.sqrt()) / (2.0 * square);
        let best = 1e6 * self.c / (2.0 * self.b);
        Some(LeastFriction {
            p_pa: Estimate {
                value: best,
                low: at(-1.0),
                high: at(1.0),
            },
            mu: self.band(best),
        })
    }
}

/// Coefficients of (t^2, t, 1), their covariance, and the sum of squared residuals.
struct Quadratic {
    coefficients: Vector3<f64>,
    covariance: Matrix3<f64>,
    chi2: f64,
}

/// Points in a scaled pressure `t = (p - centre)/width`, for conditioning.
struct Points {
    t: DVector<f64>,
    t_sd: DVector<f64>,
    mu: DVector<f64>,
    mu_sd: DVector<f64>,
    centre: f64,
    width: f64,
}

impl Points {
    fn new(experiments: &[Experiment]) -> Self {
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

    /// Unweighted least squares, with the covariance from the scatter.
    fn plain(&self) -> Result<Quadratic, Error> {
        let design = DMatrix::from_fn(self.t.len(), 3, |i, j| self.t[i].powi(2 - j as i32));
        let singular = design.singular_values();
        let ratio = singular.min() / singular.max();
        let normal = design.transpose() * &design;
        let normal = Matrix3::from_fn(|i, j| normal[(i, j)]);
        let inverse = normal.try_inverse().filter(|_| ratio > 1e-6);
        let inverse = inverse.ok_or(Error::Undetermined {
            what: "a quadratic in the pressure (three different pressures are needed)",
            ratio: if ratio.is_finite() { ratio } else { 0.0 },
        })?;
        let right = design.transpose() * &self.mu;
        let coefficients = inverse * Vector3::new(right[0], right[1], right[2]);
        let residuals = self.t.iter().zip(&self.mu);
        let residuals = residuals.map(|(t, mu)| mu - quadratic(&coefficients, *t));
        let chi2: f64 = residuals.map(|residual| residual.powi(2)).sum();
        Ok(Quadratic {
            coefficients,
            covariance: inverse * (chi2 / (self.t.len() - 3) as f64),
            chi2,
        })
    }

    /// Orthogonal distance regression, weighted by the errors of mu and p. The true pressures are
    /// eliminated (variable projection), so that memory grows with the number of points:
    ///
    /// ```text
    /// f(u) = (q(t + u s_t) - mu) / s_mu,   g = df/du,   u minimises f^2 + u^2:   u = -f g
    /// r = f sqrt(1 + g^2),   dr/dq = (df/dq) / sqrt(1 + g^2)
    /// ```
    fn orthogonal(&self, start: Vector3<f64>) -> Result<Quadratic, Error> {
        let n = self.t.len();
        // True pressure, f and g of a point.
        let nearest = |q: &Vector3<f64>, i: usize| {
            let (t_sd, mu_sd) = (self.t_sd[i], self.mu_sd[i]);
            let mut u = 0.0;
            for _ in 0..MAX_PRESSURE_STEPS {
                let t = self.t[i] + u * t_sd;
                let f = (quadratic(q, t) - self.mu[i]) / mu_sd;
                let g = (2.0 * q[0] * t + q[1]) * t_sd / mu_sd;
                let gauss_newton = 1.0 + g * g;
                let newton = gauss_newton + f * 2.0 * q[0] * t_sd * t_sd / mu_sd;
                let curvature = if newton > 0.0 { newton } else { gauss_newton };
                let step = (u + f * g) / curvature;
                if step.abs() <= PRESSURE_STEP * (1.0 + u.abs()) {
                    return (t, f, g);
                }
                u -= step;
            }
            (f64::NAN, f64::NAN, f64::NAN)
        };
        let points = |q: &DVector<f64>| {
            let q = Vector3::new(q[0], q[1], q[2]);
            (0..n).map(move |i| nearest(&q, i))
        };
        let residuals = |q: &DVector<f64>| {
            DVector::from_iterator(n, points(q).map(|(_, f, g)| f * (1.0 + g * g).sqrt()))
        };
        let jacobian = |q: &DVector<f64>| {
            let mut jacobian = DMatrix::zeros(n, 3);
            for (i, (t, _, g)) in points(q).enumerate() {
                let weight = 1.0 / (self.mu_sd[i] * (1.0 + g * g).sqrt());
                for (k, power) in [t * t, t, 1.0].into_iter().enumerate() {
                    jacobian[(i, k)] = power * weight;
                }
            }
            jacobian
        };
        let start = DVector::from_column_slice(start.as_slice());
        let (q, report) = minimize(LevenbergMarquardt::new(), start, residuals, jacobian);
        let chi2 = 2.0 * report.objective_function;
        let jacobian = report.termination.was_successful().then(|| jacobian(&q));
        let inverse =
            jacobian.and_then(|jacobian| (jacobian.transpose() * &jacobian).try_inverse());
        let inverse = inverse.ok_or(Error::NotConverged {
            what: "mu(p) fit",
            iterations: report.number_of_evaluations,
            residual: chi2,
            tolerance: f64::EPSILON,
        })?;
        Ok(Quadratic {
            coefficients: Vector3::new(q[0], q[1], q[2]),
            covariance: Matrix3::from_fn(|i, j| inverse[(i, j)]),
            chi2,
        })
    }

    /// Transforms the coefficients of (t^2, t, 1) to b, c, d.
    fn result(
        &self,
        found: &Quadratic,
        weighting: Weighting,
        confidence: f64,
        quantile: f64,
    ) -> MuFit {
        let (m, w) = (self.centre, self.width);
        let square = w * w;
        let back = Matrix3::from_row_slice(
            &[
                [1.0 / square, 0.0, 0.0],
                [2.0 * m / square, -1.0 / w, 0.0],
                [m * m / square, -m / w, 1.0],
            ]
            .concat(),
        );
        let bcd = back * found.coefficients;
        MuFit {
            b: bcd[0],
            c: bcd[1],
            d: bcd[2],
            covariance: back * found.covariance * back.transpose(),
            weighting,
            chi2: found.chi2,
            freedom: self.t.len() - 3,
            p_value: None,
            confidence,
            quantile,
        }
    }
}

fn quadratic(coefficients: &Vector3<f64>, t: f64) -> f64 {
    (coefficients[0] * t + coefficients[1]) * t + coefficients[2]
}
