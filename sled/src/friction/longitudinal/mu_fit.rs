//! A fitted quadratic of the coefficient of friction over the peak pressure, with what is known of it.

use nalgebra::{Matrix3, Vector3};

use crate::friction::estimate::Estimate;
use crate::friction::longitudinal::law::{PressureLaw, ZetaActsOn};

/// How the points are weighted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Weighting {
    /// By the stated errors of both mu and p: orthogonal distance regression.
    #[default]
    Both,
    /// None: every point alike, errors from the scatter, as in the paper.
    None,
}

/// A quadratic `mu = 1e-3 (b p^2 - c p + d)` with what is known of it.
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
    /// Weighted sum of squares in both directions; without weights the plain one [1e-6].
    pub chi2: f64,
    /// Points less parameters.
    pub freedom: usize,
    /// Probability of a larger chi2 if curve and errors are right; none without weights or freedom.
    pub p_value: Option<f64>,
    /// Probability that intervals and band are to cover.
    pub confidence: f64,
    /// Two-sided quantile that the intervals use: normal with stated errors, Student's t from the scatter.
    pub quantile: f64,
}

/// Place and height of the least friction.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
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
    pub fn band(&self, p_pa: f64) -> Estimate {
        let p = p_pa * 1e-6;
        let gradient = Vector3::new(p * p, -p, 1.0);
        let value = gradient.dot(&Vector3::new(self.b, self.c, self.d));
        let half = self.quantile
            * (gradient.dot(&(self.covariance * gradient)))
                .max(0.0)
                .sqrt();
        Estimate {
            value: 1e-3 * value,
            low: 1e-3 * (value - half),
            high: 1e-3 * (value + half),
        }
    }

    /// The minimum, where the data show one: `None` if a straight line or a maximum is within the errors.
    ///
    /// The interval holds every p with `(2 b p - c)^2 <= q^2 var(2 b p - c)` (Fieller).
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
