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

/// Arguments and arctangents inside the formula at one slip angle and load, from which those close
/// by follow without a library's function.
#[derive(Clone, Copy, Debug)]
pub struct LateralAngles {
    /// `x = B alpha` and its arctangent.
    x: (f64, f64),
    /// `(1-E) x + E atan x` and its arctangent.
    u: (f64, f64),
    /// Sine and cosine of C times that.
    wave: (f64, f64),
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

    /// Largest force over the normal force: `mu_zeta sin(C pi/2)`, with C at most 1.
    pub fn peak(&self) -> f64 {
        self.mu_zeta * (self.c.min(1.0) * std::f64::consts::FRAC_PI_2).sin()
    }

    /// Force and all its derivatives at slip angle `alpha` [rad] and normal force `fz` [N].
    ///
    /// At `fz = 0` the derivative by the load is the one-sided limit; below, everything is 0.
    pub fn derivatives(&self, alpha: f64, fz: f64) -> LateralDerivatives {
        self.derivatives_near(alpha, fz, &mut None)
    }

    /// The same, quicker where `near` holds the angles of a slip and load close by; it then has
    /// those of this one.
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
        // Above this argument the arctangents are at their ends in every digit, while x^2 would
        // overflow.
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
        let at = self.angles(x, near.as_ref());
        *near = Some(at);
        let ((x, of_x), (u, of_u), (sine, cosine)) = (at.x, at.u, at.wave);
        let du_dx = (1.0 - self.e) + self.e / (1.0 + x * x);
        let slope = cosine * du_dx / (1.0 + u * u);
        // The part of the sine that remains when the load is varied: B falls as D rises.
        let by_load = sine - self.c * x * slope;
        LateralDerivatives {
            fy: d * sine,
            alpha: self.k_n_per_rad * slope,
            fz: self.mu_zeta * by_load,
            mu_zeta: fz * by_load,
            c: d * (cosine * of_u - x * slope),
            e: d * self.c * cosine / (1.0 + u * u) * (of_x - x),
            k_n_per_rad: alpha * slope,
        }
    }

    fn angles(&self, x: f64, near: Option<&LateralAngles>) -> LateralAngles {
        let of_x = near.map_or_else(|| libm::atan(x), |near| atan_near(x, near.x));
        let u = self.inner(x, of_x);
        let of_u = near.map_or_else(|| libm::atan(u), |near| atan_near(u, near.u));
        let wave = self.c * of_u;
        LateralAngles {
            x: (x, of_x),
            u: (u, of_u),
            wave: match near {
                Some(near) => sin_cos_near(wave, self.c * near.u.1, near.wave),
                // C is small for a runner.
                None => sin_cos_near(wave, 0.0, (0.0, 1.0)),
            },
        }
    }

    /// The product `mu_zeta c`, which with K is all that small and moderate slip determine.
    pub fn mu_zeta_c(&self) -> f64 {
        self.mu_zeta * self.c
    }

    /// Checks signs and finiteness.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the key.
    pub fn check(&self) -> Result<(), Error> {
        // Small slips do not determine it: fits to them may go to any value.
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

    /// `(1-E) x + E atan x` with the arctangent of `x` known.
    fn inner(&self, x: f64, of_x: f64) -> f64 {
        if self.e == 1.0 {
            return of_x;
        }
        (1.0 - self.e) * x + self.e * of_x
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

/// Largest difference of which the series are used; the first term neglected is 4e-18 of the whole.
const NEAR: f64 = 0.05;

/// Sine and cosine of an angle [rad] from those of another, `from`; computed anew where the two are
/// far apart.
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
    // 1 - cos(d), so that what is known keeps its digits.
    let c = q * (0.5 - q * (1.0 / 24.0 - q * (1.0 / 720.0 - q * (1.0 / 40320.0))));
    (
        sine + (cosine * s - sine * c),
        cosine - (sine * s + cosine * c),
    )
}

/// The arctangent of `x` [rad] from that of another of the same sign, `from`; computed anew where
/// the two are far apart.
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
                let of_x = atan_near(to, (from, from.atan()));
                assert!(
                    (of_x - to.atan()).abs() < 4e-16 * to.atan(),
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
