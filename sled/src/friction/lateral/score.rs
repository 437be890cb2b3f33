//! The least-squares score of the magic formula in logarithms, for real and for complex slip.
//!
//! Parameters are `theta = (ln K, ln P, ln C)` with `P = mu_zeta C`: logarithms keep all three positive, and the
//! product P is what saturating data determine, whereas C apart from P hardly changes the force while C is small.

use nalgebra::{Complex, ComplexField, Matrix3, Vector3};

use crate::friction::lateral::law::MagicFormula;

/// One sample of a runner's lateral force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateralSample {
    /// Slip angle [rad].
    pub alpha: f64,
    /// Normal force [N].
    pub fz: f64,
    /// Lateral force [N].
    pub fy: f64,
    /// Number of the run, or of the stretch of a run, within which errors may be correlated.
    pub cluster: u32,
}

/// The point `theta` of a model.
pub(crate) fn theta_of(model: &MagicFormula) -> Vector3<f64> {
    Vector3::new(
        model.k_n_per_rad.ln(),
        (model.mu_zeta * model.c).ln(),
        model.c.ln(),
    )
}

/// The model at a point `theta`.
pub(crate) fn model_of(theta: &Vector3<f64>, e: f64) -> MagicFormula {
    MagicFormula {
        k_n_per_rad: theta[0].exp(),
        mu_zeta: (theta[1] - theta[2]).exp(),
        c: theta[2].exp(),
        e,
    }
}

/// Force and its gradient by `theta`, all in newtons.
///
/// ```text
/// x = K alpha / (P F_z),   u = (1-E) x + E atan x,   f = (P F_z / C) sin(C atan u)
/// f_lnK = K alpha cos(C atan u) u'(x) / (1+u^2)
/// f_lnP = f - f_lnK,   f_lnC = P F_z atan(u) cos(C atan u) - f
/// ```
pub(crate) fn force_and_gradient<T: ComplexField<RealField = f64>>(
    model: &MagicFormula,
    alpha: T,
    fz: f64,
) -> (T, [T; 3]) {
    let one = T::one();
    let real = |value: f64| T::from_real(value);
    let reach = model.mu_zeta * model.c * fz;
    let x = alpha.clone() * real(model.k_n_per_rad / reach);
    let u = x.clone() * real(1.0 - model.e) + x.clone().atan() * real(model.e);
    let angle = u.clone().atan();
    let (sine, cosine) = (angle.clone() * real(model.c)).sin_cos();
    let f = sine * real(reach / model.c);
    let du_dx = real(1.0 - model.e) + real(model.e) / (one.clone() + x.clone() * x);
    let by_k = alpha * real(model.k_n_per_rad) * cosine.clone() * du_dx / (one + u.clone() * u);
    let by_p = f.clone() - by_k.clone();
    let by_c = angle * cosine * real(reach) - f.clone();
    (f, [by_k, by_p, by_c])
}

/// Sums over samples of the score `(f_y - f) grad f` and of its slope `grad f grad f^T`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    pub score: Vector3<f64>,
    pub slope: Matrix3<f64>,
}

impl Score {
    pub(crate) const ZERO: Score = Score {
        score: Vector3::new(0.0, 0.0, 0.0),
        slope: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    pub(crate) fn add(&mut self, other: &Score) {
        self.score += other.score;
        self.slope += other.slope;
    }

    /// Score of one sample whose slip carries noise of standard deviation `slip_sd`, unbiased for the score at the true slip.
    ///
    /// For an analytic h and Gaussian noise eta, `E[h(xi + eta + i eta')] = h(xi)` with an independent copy
    /// eta'; three Gauss-Hermite nodes over eta' give `h* = 2/3 h(alpha) + 1/3 Re h(alpha + i sqrt(3) sd)`, exact to
    /// the fifth power of the noise (Novick and Stefanski, J. Am. Stat. Assoc. 97 (2002) 472).
    pub(crate) fn of_sample(model: &MagicFormula, sample: &LateralSample, slip_sd: f64) -> Score {
        let (f, g) = force_and_gradient(model, sample.alpha, sample.fz);
        let mut sum = Score::ZERO;
        let direct = if slip_sd > 0.0 { 2.0 / 3.0 } else { 1.0 };
        for i in 0..3 {
            sum.score[i] = direct * (sample.fy - f) * g[i];
            for j in 0..3 {
                sum.slope[(i, j)] = direct * g[i] * g[j];
            }
        }
        if slip_sd > 0.0 {
            let shifted = Complex::new(sample.alpha, 3f64.sqrt() * slip_sd);
            let (f, g) = force_and_gradient(model, shifted, sample.fz);
            for i in 0..3 {
                sum.score[i] += ((Complex::from(sample.fy) - f) * g[i]).re / 3.0;
                for j in 0..3 {
                    sum.slope[(i, j)] += (g[i] * g[j]).re / 3.0;
                }
            }
        }
        sum
    }
}
