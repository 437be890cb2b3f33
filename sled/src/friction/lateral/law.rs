//! Lateral friction: the paper's magic formula and Braghin's model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, in_range};

/// Pacejka's magic formula as the paper uses it for a runner on ice.
///
/// ```text
/// F_y = D sin( C atan( (1-E) x + E atan x ) ),   x = B alpha,   D = mu_zeta F_z,   B = K / (C D)
/// ```
///
/// The slope at zero slip is K whatever the load; the force saturates at `D sin(C pi/2)`. Since C
/// is small for a runner, C and mu_zeta act almost only through their product.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MagicFormula {
    /// Lateral friction coefficient times asperity factor, dimensionless.
    pub mu_zeta: f64,
    /// Shape factor C, dimensionless.
    pub c: f64,
    /// Curvature factor E, dimensionless, at most 1.
    pub e: f64,
    /// Cornering stiffness K [N/rad].
    pub k_n_per_rad: f64,
}

/// Lateral force with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LateralDerivatives {
    /// The force itself [N].
    pub fy: f64,
    /// By the slip angle [N/rad].
    pub alpha: f64,
    /// By the normal force, dimensionless.
    pub fz: f64,
    /// By `mu_zeta` [N].
    pub mu_zeta: f64,
    /// By `c` [N].
    pub c: f64,
    /// By `e` [N].
    pub e: f64,
    /// By `k_n_per_rad` [rad].
    pub k_n_per_rad: f64,
}

/// Intermediate angles of the formula at one slip angle and load. Angles at a nearby slip and load
/// follow from them by short series, without calls of the mathematical library.
#[derive(Clone, Copy, Debug)]
pub struct LateralAngles {
    /// `x = B alpha` and `atan x`.
    x: (f64, f64),
    /// `u = (1-E) x + E atan x` and `atan u`.
    u: (f64, f64),
    /// Sine and cosine of `C atan u`.
    sine_cosine: (f64, f64),
}

impl MagicFormula {
    /// The published front runner.
    pub const PUBLISHED_FRONT: MagicFormula = MagicFormula {
        mu_zeta: 2.577,
        c: 0.024,
        e: 0.99,
        k_n_per_rad: 10522.0,
    };
    /// The published rear runner.
    pub const PUBLISHED_REAR: MagicFormula = MagicFormula {
        mu_zeta: 3.288,
        c: 0.076,
        e: 0.99,
        k_n_per_rad: 49776.0,
    };

    /// Lateral force [N] at slip angle `alpha` [rad] and normal force `fz` [N].
    ///
    /// A lifted runner (`fz` of 0 or less) has no force; NaN gives NaN.
    ///
    /// ```
    /// let front = kufe_sled::friction::MagicFormula::PUBLISHED_FRONT;
    /// let small = 1e-6;
    /// assert!((front.force(small, 2000.0) / small - 10522.0).abs() < 1.0);
    /// ```
    pub fn force(&self, alpha: f64, fz: f64) -> f64 {
        if fz <= 0.0 {
            return 0.0;
        }
        let d = self.mu_zeta * fz;
        let x = self.k_n_per_rad * alpha / (self.c * d);
        d * (self.c * self.inner(x, x.atan()).atan()).sin()
    }

    /// Ratio of the largest lateral force to the normal force: `mu_zeta sin(min(C, 1) pi/2)`.
    pub fn peak(&self) -> f64 {
        self.mu_zeta * (self.c.min(1.0) * std::f64::consts::FRAC_PI_2).sin()
    }

    /// Force and all its derivatives at slip angle `alpha` [rad] and normal force `fz` [N].
    ///
    /// At `fz = 0` the derivative with respect to the load is the one-sided limit; for `fz < 0`
    /// everything is 0.
    pub fn derivatives(&self, alpha: f64, fz: f64) -> LateralDerivatives {
        self.derivatives_near(alpha, fz, &mut None)
    }

    /// As [`derivatives`](Self::derivatives), faster if `near` contains the angles of a nearby slip
    /// and load. On return `near` contains the angles of this slip and load.
    pub fn derivatives_near(
        &self,
        alpha: f64,
        fz: f64,
        near: &mut Option<LateralAngles>,
    ) -> LateralDerivatives {
        if fz < 0.0 || (fz == 0.0 && alpha == 0.0) {
            return LateralDerivatives::default();
        }
        let d = self.mu_zeta * fz;
        let x = self.k_n_per_rad * alpha / (self.c * d);
        // Above this argument the arctangents are equal to their limits in every digit, and x^2
        // would overflow.
        if x.abs() > 1e100 {
            let right = std::f64::consts::FRAC_PI_2;
            let end = if self.e < 1.0 { right } else { right.atan() };
            let (sine, cosine) = (self.c * end).sin_cos();
            let sign = x.signum();
            return LateralDerivatives {
                fy: d * sine * sign,
                fz: self.mu_zeta * sine * sign,
                mu_zeta: fz * sine * sign,
                c: d * cosine * end * sign,
                ..Default::default()
            };
        }
        let angles = self.angles(x, near.as_ref());
        *near = Some(angles);
        let ((x, atan_x), (u, atan_u), (sine, cosine)) = (angles.x, angles.u, angles.sine_cosine);
        let du_dx = (1.0 - self.e) + self.e / (1.0 + x * x);
        let slope = cosine * du_dx / (1.0 + u * u);
        // Derivative of the force with respect to D: B falls as D rises.
        let by_load = sine - self.c * x * slope;
        LateralDerivatives {
            fy: d * sine,
            alpha: self.k_n_per_rad * slope,
            fz: self.mu_zeta * by_load,
            mu_zeta: fz * by_load,
            c: d * (cosine * atan_u - x * slope),
            e: d * self.c * cosine / (1.0 + u * u) * (atan_x - x),
            k_n_per_rad: alpha * slope,
        }
    }

    fn angles(&self, x: f64, near: Option<&LateralAngles>) -> LateralAngles {
        let atan_x = near.map_or_else(|| libm::atan(x), |near| atan_near(x, near.x));
        let u = self.inner(x, atan_x);
        let atan_u = near.map_or_else(|| libm::atan(u), |near| atan_near(u, near.u));
        let angle = self.c * atan_u;
        LateralAngles {
            x: (x, atan_x),
            u: (u, atan_u),
            sine_cosine: match near {
                Some(near) => sin_cos_near(angle, self.c * near.u.1, near.sine_cosine),
                // C is small for a runner.
                None => sin_cos_near(angle, 0.0, (0.0, 1.0)),
            },
        }
    }

    /// The product `mu_zeta c`. Data of small and moderate slip determine only it and K.
    pub fn mu_zeta_c(&self) -> f64 {
        self.mu_zeta * self.c
    }

    /// Checks signs and finiteness.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the key.
    pub fn check(&self) -> Result<(), Error> {
        // No upper bound: fits to small slips do not determine it and may give any value.
        in_range(
            "mu_zeta",
            self.mu_zeta,
            self.mu_zeta > 0.0,
            "a positive number",
        )?;
        let c = self.c > 0.0 && self.c < 2.0;
        in_range("c", self.c, c, "above 0, below 2")?;
        in_range("e", self.e, self.e <= 1.0, "at most 1")?;
        let k = self.k_n_per_rad;
        in_range(
            "k_n_per_rad",
            k,
            k > 0.0 && k <= 1e9,
            "above 0, up to 1e9 N/rad",
        )
    }

    /// `(1-E) x + E atan x` from `x` and its arctangent.
    fn inner(&self, x: f64, atan_x: f64) -> f64 {
        if self.e == 1.0 {
            return atan_x;
        }
        (1.0 - self.e) * x + self.e * atan_x
    }
}

/// Braghin's lateral friction, `F_y = mu_y F_z (2/pi) atan(k3 alpha)`, the paper's comparison.
///
/// Source: F. Braghin et al. (2011), as quoted in the paper's first equation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Braghin {
    /// Lateral friction coefficient, dimensionless.
    pub mu_y: f64,
    /// Steepness [1/rad].
    pub k3: f64,
}

impl Braghin {
    /// The published parameters, used for both axles.
    pub const PUBLISHED: Braghin = Braghin {
        mu_y: 0.5,
        k3: 50.0,
    };

    /// Lateral force [N] at slip angle `alpha` [rad] and normal force `fz` [N]; 0 for a lifted
    /// runner.
    pub fn force(&self, alpha: f64, fz: f64) -> f64 {
        if fz <= 0.0 {
            return 0.0;
        }
        self.mu_y * fz * std::f64::consts::FRAC_2_PI * (self.k3 * alpha).atan()
    }
}

/// Largest difference for which the series are used; the first neglected term is 4e-18 relative to
/// the sum.
const NEAR: f64 = 0.05;

/// Sine and cosine of `angle` [rad] from the known sine and cosine of `from` [rad], by a series in
/// their difference; by the library if they differ by more than 0.05.
///
/// ```
/// let known = 0.3_f64.sin_cos();
/// let (sine, cosine) = kufe_sled::friction::sin_cos_near(0.31, 0.3, known);
/// assert!((sine - 0.31_f64.sin()).abs() < 2e-16 && (cosine - 0.31_f64.cos()).abs() < 2e-16);
/// ```
#[inline]
pub fn sin_cos_near(angle: f64, from: f64, (sine, cosine): (f64, f64)) -> (f64, f64) {
    let d = angle - from;
    if d == 0.0 {
        return (sine, cosine);
    }
    if d.abs() > NEAR || d.is_nan() {
        return libm::sincos(angle);
    }
    let q = d * d;
    let s = d
        * (1.0 - q * (1.0 / 6.0 - q * (1.0 / 120.0 - q * (1.0 / 5040.0 - q * (1.0 / 362_880.0)))));
    // 1 - cos(d), so that the known values keep their digits.
    let c = q * (0.5 - q * (1.0 / 24.0 - q * (1.0 / 720.0 - q * (1.0 / 40320.0))));
    (
        sine + (cosine * s - sine * c),
        cosine - (sine * s + cosine * c),
    )
}

/// The arctangent of `x` [rad] from that of `from`, by a series; by the library if the two are far
/// apart or differ in sign.
#[inline]
fn atan_near(x: f64, (from, of_from): (f64, f64)) -> f64 {
    let d = (x - from) / (1.0 + x * from);
    if d.is_nan() || d.abs() > NEAR || x * from < 0.0 {
        return libm::atan(x);
    }
    let q = d * d;
    let rest =
        q * (1.0 / 5.0 - q * (1.0 / 7.0 - q * (1.0 / 9.0 - q * (1.0 / 11.0 - q * (1.0 / 13.0)))));
    of_from + d * (1.0 - q * (1.0 / 3.0 - rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_close_by_is_that_of_the_library_to_rounding() {
        for k in 0..2000 {
            let from = (f64::from(k) * 0.7311).sin() * 6.0;
            for d in [0.0, 1e-9, -1e-4, 3e-3, -0.049, 0.0499, 0.2] {
                let to = from + d;
                let (sine, cosine) = sin_cos_near(to, from, from.sin_cos());
                assert!((sine - to.sin()).abs() < 3e-16, "sin {to} from {from}");
                assert!((cosine - to.cos()).abs() < 3e-16, "cos {to} from {from}");
                let (to, from) = (to.exp2(), from.exp2());
                let atan_x = atan_near(to, (from, from.atan()));
                assert!(
                    (atan_x - to.atan()).abs() < 4e-16 * to.atan(),
                    "atan {to} from {from}"
                );
            }
        }
        assert!(sin_cos_near(f64::NAN, 0.0, (0.0, 1.0)).0.is_nan());
        assert!(atan_near(f64::NAN, (1.0, 1.0_f64.atan())).is_nan());
        assert_eq!(
            atan_near(f64::INFINITY, (1.0, 1.0_f64.atan())),
            std::f64::consts::FRAC_PI_2
        );
    }
}
