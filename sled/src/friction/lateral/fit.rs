//! Fit of the magic formula to measured slip angles, loads and lateral forces.
//!
//! Ordinary least squares assumes an exact slip angle. Noise in the slip flattens the fitted curve
//! (attenuation), however many data there are. The fit therefore starts from least squares
//! (Levenberg-Marquardt) and goes on to the root of a corrected score that is unbiased for slip
//! noise of a stated standard deviation. Confidence intervals come from a jackknife over clusters
//! (runs), so that correlation within a run does not make them too narrow.

use std::collections::BTreeMap;
use std::ops::Add;

use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{Complex, ComplexField, DMatrix, DVector, Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, in_range};
use crate::friction::estimate::student_quantile;
use crate::friction::lateral::law::MagicFormula;
use crate::friction::least_squares::minimize;

/// The fitted law of one runner with the confidence intervals of its parameters, as in `fit.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LateralFit {
    /// Peak factor over load, mu_y zeta_y; conditional on C where C is fixed.
    pub mu_zeta: Interval,
    /// Shape factor C.
    pub c: Interval,
    /// Curvature factor E, predefined.
    pub e: Interval,
    /// Stiffness at zero slip [N/rad].
    pub k_n_per_rad: Interval,
    /// Product of `mu_zeta` and `c`, which saturation determines.
    pub mu_zeta_c: Interval,
    /// Whether C is fixed at the model's value because the data do not determine it.
    pub c_held: bool,
    /// Whether the data determine `mu_zeta_c`; if not, it is 0 or more and only K counts.
    pub mu_zeta_c_determined: bool,
    /// Number of parameter combinations that the data determine.
    pub rank: usize,
    /// Standard deviation of the noise in the slip angles [rad].
    pub slip_sd_rad: f64,
    /// Ratio of the stiffness by plain least squares to the corrected stiffness.
    pub attenuation_of_plain_least_squares: f64,
    /// The law by plain least squares, without the correction for slip noise.
    pub plain_least_squares: MagicFormula,
    /// Root mean square residual [N].
    pub residual_rms_n: f64,
    /// Samples used.
    pub samples: usize,
    /// Number of clusters (runs, or stretches of one run) of the jackknife.
    pub clusters: usize,
    /// Principal parameter combinations of the fit with all three parameters free, the best
    /// determined first; not part of the document.
    #[serde(skip)]
    pub combinations: [Combination; 3],
}

impl LateralFit {
    /// The fitted law, with attenuation corrected.
    pub fn law(&self) -> MagicFormula {
        MagicFormula {
            mu_zeta: self.mu_zeta.value,
            c: self.c.value,
            e: self.e.value,
            k_n_per_rad: self.k_n_per_rad.value,
        }
    }
}

/// An estimate with its confidence interval; `None` for an end that the data do not bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Interval {
    /// Best value.
    pub value: f64,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

/// Confidence level of the intervals.
pub(crate) const CONFIDENCE: f64 = 0.95;
/// Smallest number of samples of a fit.
const MIN_SAMPLES: usize = 20;
/// Factor on mu_zeta C that makes the curve a straight line over the data.
const STRAIGHT_LINE_FACTOR: f64 = 1e4;
/// Largest imaginary part of the scaled slip x; the nearest singularity of the formula is at 1.
const MAX_SHIFT: f64 = 0.5;

/// Fits the magic formula with predefined E to one runner's samples.
///
/// If all samples are in one cluster, it is cut into twenty stretches in the given order.
///
/// # Errors
/// [`Error::TooFew`], [`Error::OutOfRange`] for NaN or options out of range,
/// [`Error::Undetermined`] if the data do not determine K or if slip noise exceeds the slip,
/// [`Error::NotConverged`].
pub fn fit_lateral(
    samples: &[LateralSample],
    options: &LateralFitOptions,
) -> Result<LateralFit, Error> {
    check_input(samples, options)?;
    let mut used: Vec<LateralSample> = samples.iter().copied().filter(|s| s.fz > 0.0).collect();
    check_count(used.len())?;
    cut_single_cluster(&mut used);
    let start = first_guess(&used, options)?;
    let fixed = [true, true, false];
    let mut start_fit = least_squares(&used, start, fixed)?;
    if options.slip_sd > 0.0 {
        // Below this load the imaginary part of the scaled slip exceeds its limit.
        let min_load = 3f64.sqrt() * options.slip_sd * start_fit.k_n_per_rad
            / (start_fit.mu_zeta_c() * MAX_SHIFT);
        let loaded: Vec<LateralSample> = used.iter().copied().filter(|s| s.fz > min_load).collect();
        if loaded.len() < used.len() {
            check_count(loaded.len())?;
            used = loaded;
            start_fit = least_squares(&used, start_fit, fixed)?;
        }
    }
    let (mut free, least_squares_model, combinations) = choose_freedom(&used, start_fit, options)?;
    let attempt = |start: &MagicFormula, free: [bool; 3]| {
        let theta = corrected_root(&used, start, free, options)?;
        let model = model_of(&theta, options.e);
        let covariance = leave_one_cluster_out(&used, &model, free, options.slip_sd)?;
        Ok::<_, Error>((theta, model, covariance))
    };
    let both = attempt(&least_squares_model, free);
    let is_determined = |covariance: &Matrix3<f64>| covariance[(1, 1)].sqrt() < Combination::LIMIT;
    let product_determined = both
        .as_ref()
        .is_ok_and(|(.., covariance)| is_determined(covariance));
    // If the best product is infinite, the curve is a straight line, and only K is fitted.
    let (theta, model, covariance) = match both {
        Ok(both) => both,
        Err(Error::Undetermined { .. } | Error::NotConverged { .. }) => {
            free = [true, false, false];
            let straight = MagicFormula {
                mu_zeta: STRAIGHT_LINE_FACTOR * least_squares_model.mu_zeta,
                ..least_squares_model
            };
            attempt(&straight, free)?
        }
        Err(other) => return Err(other),
    };
    let clusters = by_cluster(&used, &model, options.slip_sd).len();
    let quantile = student_quantile(CONFIDENCE, clusters - 1);
    let interval = |value: f64, low: f64, high: f64| {
        let [low, high] = [low, high].map(|end| Some(end).filter(|end| end.is_finite()));
        Interval { value, low, high }
    };
    let estimate = |log: f64, variance: f64| {
        let half = quantile * variance.max(0.0).sqrt();
        interval(log.exp(), (log - half).exp(), (log + half).exp())
    };
    let or_unknown = |mut estimate: Interval| {
        if !product_determined {
            (estimate.low, estimate.high) = (Some(0.0), None);
        }
        estimate
    };
    let mu_zeta_variance = covariance[(1, 1)] + covariance[(2, 2)] - 2.0 * covariance[(1, 2)];
    Ok(LateralFit {
        e: interval(options.e, options.e, options.e),
        k_n_per_rad: estimate(theta[0], covariance[(0, 0)]),
        mu_zeta_c: or_unknown(estimate(theta[1], covariance[(1, 1)])),
        mu_zeta: or_unknown(estimate(theta[1] - theta[2], mu_zeta_variance)),
        c: estimate(theta[2], covariance[(2, 2)]),
        c_held: !free[2],
        mu_zeta_c_determined: product_determined,
        rank: rank(&combinations),
        combinations,
        plain_least_squares: least_squares_model,
        attenuation_of_plain_least_squares: least_squares_model.k_n_per_rad / model.k_n_per_rad,
        slip_sd_rad: options.slip_sd,
        residual_rms_n: (squares(&used, &model) / used.len() as f64).sqrt(),
        samples: used.len(),
        clusters,
    })
}

fn check_count(found: usize) -> Result<(), Error> {
    let what = "lateral fit: samples with enough load";
    let error = || Error::too_few(what, found, MIN_SAMPLES);
    (found >= MIN_SAMPLES).then_some(()).ok_or_else(error)
}

/// Sum of the squared residual forces [N2].
fn squares(samples: &[LateralSample], model: &MagicFormula) -> f64 {
    let residual = |s: &LateralSample| s.fy - model.force(s.alpha, s.fz);
    samples.iter().map(|s| residual(s).powi(2)).sum()
}

fn check_input(samples: &[LateralSample], options: &LateralFitOptions) -> Result<(), Error> {
    in_range("e", options.e, options.e <= 1.0, "at most 1")?;
    let c = options.c > 0.0 && options.c < 2.0;
    in_range("c", options.c, c, "above 0, below 2")?;
    let slip_sd = (0.0..0.1).contains(&options.slip_sd);
    in_range("slip_sd", options.slip_sd, slip_sd, "0 to 0.1 rad")?;
    for LateralSample { alpha, fz, fy, .. } in samples {
        let slip = alpha.abs() < std::f64::consts::FRAC_PI_2;
        in_range("slip angle", *alpha, slip, "radians within a quarter turn")?;
        in_range("normal force", *fz, true, "a finite force [N]")?;
        in_range("lateral force", *fy, true, "a finite force [N]")?;
    }
    Ok(())
}

fn cut_single_cluster(samples: &mut [LateralSample]) {
    const STRETCHES: usize = 20;
    if samples.iter().all(|s| s.cluster == samples[0].cluster) {
        let length = samples.len().div_ceil(STRETCHES);
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.cluster = (i / length) as u32;
        }
    }
}

/// Starting values: K from a straight line through the origin, mu_zeta C from the 90 % quantile of
/// `|F_y / F_z|`.
fn first_guess(
    samples: &[LateralSample],
    options: &LateralFitOptions,
) -> Result<MagicFormula, Error> {
    let slip_square: f64 = samples.iter().map(|s| s.alpha * s.alpha).sum();
    let true_square = slip_square - samples.len() as f64 * options.slip_sd * options.slip_sd;
    if true_square <= 0.02 * slip_square {
        return Err(Error::Undetermined {
            what: "cornering stiffness K (the slip is within its noise)",
            // 0 of 0 is 0.
            ratio: (true_square / slip_square).max(0.0),
        });
    }
    let product: f64 = samples.iter().map(|s| s.alpha * s.fy).sum();
    let mut friction: Vec<f64> = samples.iter().map(|s| (s.fy / s.fz).abs()).collect();
    friction.sort_by(f64::total_cmp);
    let p = friction[friction.len() * 9 / 10].max(1e-6);
    let k_n_per_rad = product / true_square;
    let (name, positive) = ("cornering stiffness of a straight line", k_n_per_rad > 0.0);
    let expected = "positive: check the signs of slip and force";
    in_range(name, k_n_per_rad, positive, expected)?;
    Ok(MagicFormula {
        mu_zeta: p / options.c,
        c: options.c,
        e: options.e,
        k_n_per_rad,
    })
}

/// Fixed parameters and slip noise of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateralFitOptions {
    /// Curvature factor E, predefined and not fitted.
    pub e: f64,
    /// Value at which the shape factor C is fixed if the data do not determine it.
    pub c: f64,
    /// Standard deviation of the noise in the given slip angles, after any filter [rad]; 0 for
    /// exact slip angles.
    pub slip_sd: f64,
}

impl Default for LateralFitOptions {
    fn default() -> Self {
        LateralFitOptions {
            e: 0.99,
            c: 0.05,
            slip_sd: 0.0,
        }
    }
}

// Least-squares score of the magic formula, for real and for complex slip.
//
// The parameters are `theta = (ln K, ln P, ln C)` with `P = mu_zeta C`. The logarithms keep all
// three positive. Saturating data determine the product P; at a given P, a small C hardly changes
// the force.

/// One sample of a runner's lateral force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateralSample {
    /// Slip angle [rad].
    pub alpha: f64,
    /// Normal force [N].
    pub fz: f64,
    /// Lateral force [N].
    pub fy: f64,
    /// Number of the cluster: a run, or a stretch of a run, within which errors may be correlated.
    pub cluster: u32,
}

/// Parameters `theta` of a model.
fn theta_of(model: &MagicFormula) -> Vector3<f64> {
    let (k, product) = (model.k_n_per_rad.ln(), model.mu_zeta_c().ln());
    Vector3::new(k, product, model.c.ln())
}

/// The model with parameters `theta`.
fn model_of(theta: &Vector3<f64>, e: f64) -> MagicFormula {
    MagicFormula {
        k_n_per_rad: theta[0].exp(),
        mu_zeta: (theta[1] - theta[2]).exp(),
        c: theta[2].exp(),
        e,
    }
}

/// Force and its gradient with respect to `theta`, all in newtons.
///
/// ```text
/// x = K alpha / (P F_z),   u = (1-E) x + E atan x,   f = (P F_z / C) sin(C atan u)
/// f_lnK = K alpha cos(C atan u) u'(x) / (1+u^2)
/// f_lnP = f - f_lnK,   f_lnC = P F_z atan(u) cos(C atan u) - f
/// ```
fn force_and_gradient<T: ComplexField<RealField = f64>>(
    model: &MagicFormula,
    alpha: T,
    fz: f64,
) -> (T, [T; 3]) {
    let one = T::one();
    let real = |value: f64| T::from_real(value);
    let product_n = model.mu_zeta * model.c * fz;
    let x = alpha.clone() * real(model.k_n_per_rad / product_n);
    let u = x.clone() * real(1.0 - model.e) + x.clone().atan() * real(model.e);
    let angle = u.clone().atan();
    let (sine, cosine) = (angle.clone() * real(model.c)).sin_cos();
    let f = sine * real(product_n / model.c);
    let du_dx = real(1.0 - model.e) + real(model.e) / (one.clone() + x.clone() * x);
    let by_k = alpha * real(model.k_n_per_rad) * cosine.clone() * du_dx / (one + u.clone() * u);
    let by_p = f.clone() - by_k.clone();
    let by_c = angle * cosine * real(product_n) - f.clone();
    (f, [by_k, by_p, by_c])
}

/// Sums over samples of the score `(f_y - f) grad f` and of its slope `grad f grad f^T`.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    score: Vector3<f64>,
    slope: Matrix3<f64>,
}

impl Add for Score {
    type Output = Score;

    fn add(self, other: Score) -> Score {
        Score {
            score: self.score + other.score,
            slope: self.slope + other.slope,
        }
    }
}

impl Score {
    /// Score of one sample whose slip carries noise of standard deviation `slip_sd`, unbiased for
    /// the score at the true slip.
    ///
    /// For an analytic h and Gaussian noise eta, `E[h(xi + eta + i eta')] = h(xi)` with an
    /// independent copy eta'; three Gauss-Hermite nodes over eta' give
    /// `h* = 2/3 h(alpha) + 1/3 Re h(alpha + i sqrt(3) sd)`, exact to the fifth power of the noise
    /// (Novick and Stefanski, J. Am. Stat. Assoc. 97 (2002) 472).
    fn of_sample(model: &MagicFormula, sample: &LateralSample, slip_sd: f64) -> Score {
        let (f, g) = force_and_gradient(model, sample.alpha, sample.fz);
        let direct = if slip_sd > 0.0 { 2.0 / 3.0 } else { 1.0 };
        let mut sum = Score {
            score: Vector3::from_fn(|i, _| direct * (sample.fy - f) * g[i]),
            slope: Matrix3::from_fn(|i, j| direct * g[i] * g[j]),
        };
        if slip_sd > 0.0 {
            let shifted = Complex::new(sample.alpha, 3f64.sqrt() * slip_sd);
            let (f, g) = force_and_gradient(model, shifted, sample.fz);
            let residual = Complex::from(sample.fy) - f;
            sum.score += Vector3::from_fn(|i, _| (residual * g[i]).re / 3.0);
            sum.slope += Matrix3::from_fn(|i, j| (g[i] * g[j]).re / 3.0);
        }
        sum
    }
}

/// A direction in `(ln K, ln(mu_zeta C), ln C)` with its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Combination {
    /// Exponents of K, mu_zeta C and C, a unit vector.
    pub exponents: [f64; 3],
    /// Standard deviation of the logarithm of the combination, robust to correlation within
    /// clusters.
    pub relative_sd: f64,
}

impl Combination {
    /// Largest `relative_sd` of a determined combination: a factor of about 1.6 at 95 %.
    pub const LIMIT: f64 = 0.25;

    /// Whether the data determine it.
    pub fn is_determined(&self) -> bool {
        self.relative_sd < Combination::LIMIT
    }
}

/// Number of combinations that the data determine.
fn rank(combinations: &[Combination; 3]) -> usize {
    combinations.iter().filter(|c| c.is_determined()).count()
}

/// Least squares over the free parameters by Levenberg-Marquardt.
fn least_squares(
    samples: &[LateralSample],
    start: MagicFormula,
    free: [bool; 3],
) -> Result<MagicFormula, Error> {
    let free: Vec<usize> = (0..3).filter(|&i| free[i]).collect();
    let whole = theta_of(&start);
    let model = |x: &DVector<f64>| {
        let mut theta = whole;
        for (&i, &x) in free.iter().zip(x) {
            theta[i] = x;
        }
        model_of(&theta, start.e)
    };
    let residuals = |x: &DVector<f64>| {
        let model = model(x);
        let residual = |s: &LateralSample| model.force(s.alpha, s.fz) - s.fy;
        DVector::from_iterator(samples.len(), samples.iter().map(residual))
    };
    let jacobian = |x: &DVector<f64>| {
        let model = model(x);
        let gradients = samples.iter().flat_map(|sample| {
            let (_, gradient) = force_and_gradient(&model, sample.alpha, sample.fz);
            free.iter().map(move |&i| gradient[i])
        });
        DMatrix::from_row_iterator(samples.len(), free.len(), gradients)
    };
    // Looser than rounding: the last digits along an undetermined direction would take most of the
    // time, and the corrected score refines the parameters.
    let method = LevenbergMarquardt::new().with_ftol(1e-12).with_xtol(1e-10);
    let from = DVector::from_iterator(free.len(), free.iter().map(|&i| whole[i]));
    let (found, report) = minimize(method, from, residuals, jacobian);
    let model = model(&found);
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

/// Decides by the three-parameter fit whether C is a free parameter.
fn choose_freedom(
    samples: &[LateralSample],
    fixed: MagicFormula,
    options: &LateralFitOptions,
) -> Result<([bool; 3], MagicFormula, [Combination; 3]), Error> {
    let mut best = fixed;
    for c in [options.c, 1.0] {
        let start = MagicFormula {
            mu_zeta: fixed.mu_zeta_c() / c,
            c,
            ..fixed
        };
        // A direction without curvature may stop the search early; the fit with C fixed is then the
        // better one.
        if let Ok(found) = least_squares(samples, start, [true; 3])
            && found.c < 2.0
            && squares(samples, &found) < squares(samples, &best)
        {
            best = found;
        }
    }
    let combinations = combinations_of(samples, &best, options.slip_sd);
    if rank(&combinations) == 3 {
        return Ok(([true; 3], best, combinations));
    }
    let combinations = combinations_of(samples, &fixed, options.slip_sd);
    if !combinations[0].is_determined() {
        return Err(Error::Undetermined {
            what: "cornering stiffness K",
            ratio: Combination::LIMIT / combinations[0].relative_sd,
        });
    }
    Ok(([true, true, false], fixed, combinations))
}

/// Parameter combinations, best determined first: right singular vectors of the Jacobian in falling
/// order of their singular values. Their standard deviations come from the covariance of the summed
/// score (sandwich estimator).
fn combinations_of(
    samples: &[LateralSample],
    model: &MagicFormula,
    slip_sd: f64,
) -> [Combination; 3] {
    let clusters = by_cluster(samples, model, slip_sd);
    let scores = clusters.values().map(|cluster| cluster.score);
    let meat: Matrix3<f64> = scores.map(|score| score * score.transpose()).sum();
    let total = clusters.into_values().fold(Score::default(), Score::add);
    let eigen = total.slope.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    order.map(|k| {
        let mut direction: Vector3<f64> = eigen.eigenvectors.column(k).into();
        if direction[direction.iamax()] < 0.0 {
            direction = -direction;
        }
        let curvature = eigen.eigenvalues[k].max(0.0);
        let spread = (direction.transpose() * meat * direction)[0].max(0.0);
        let relative_sd = (curvature > 0.0).then(|| spread.sqrt() / curvature);
        Combination {
            exponents: direction.into(),
            relative_sd: relative_sd.unwrap_or(f64::INFINITY),
        }
    })
}

fn by_cluster(
    samples: &[LateralSample],
    model: &MagicFormula,
    slip_sd: f64,
) -> BTreeMap<u32, Score> {
    let mut clusters: BTreeMap<u32, Score> = BTreeMap::new();
    for sample in samples {
        let cluster = clusters.entry(sample.cluster).or_default();
        *cluster = *cluster + Score::of_sample(model, sample, slip_sd);
    }
    clusters
}

/// Step `slope^-1 score` over the free parameters, 0 for the fixed ones; `None` if the slope is not
/// positive definite.
fn step(slope: &Matrix3<f64>, score: &Vector3<f64>, free: [bool; 3]) -> Option<Vector3<f64>> {
    let indices: Vec<usize> = (0..3).filter(|&i| free[i]).collect();
    let n = indices.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| slope[(indices[i], indices[j])]);
    let right = DVector::from_fn(n, |i, _| score[indices[i]]);
    let solved = matrix.cholesky()?.solve(&right);
    let mut whole = Vector3::zeros();
    for (i, &k) in indices.iter().enumerate() {
        whole[k] = solved[i];
    }
    Some(whole)
}

/// Root of the corrected score by Gauss-Newton steps from the least-squares fit; a step is at most
/// 1 long in `theta`.
fn corrected_root(
    samples: &[LateralSample],
    start: &MagicFormula,
    free: [bool; 3],
    options: &LateralFitOptions,
) -> Result<Vector3<f64>, Error> {
    const MAX_ITERATIONS: usize = 100;
    const TOLERANCE: f64 = 1e-9;
    let mut theta = theta_of(start);
    let mut length = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        let model = model_of(&theta, options.e);
        let scores = samples
            .iter()
            .map(|s| Score::of_sample(&model, s, options.slip_sd));
        let total = scores.fold(Score::default(), Score::add);
        let Some(move_by) = step(&total.slope, &total.score, free) else {
            return Err(Error::Undetermined {
                what: "K with mu_zeta*c (slip too small relative to its noise, or no saturation)",
                ratio: 0.0,
            });
        };
        length = move_by.norm();
        theta += move_by / length.max(1.0);
        if length < TOLERANCE {
            return Ok(theta);
        }
    }
    Err(Error::NotConverged {
        what: "lateral fit, corrected score",
        iterations: MAX_ITERATIONS,
        residual: length,
        tolerance: TOLERANCE,
    })
}

/// Jackknife covariance: leaves out one cluster at a time, with one Newton step each ("CR3" of Bell
/// and McCaffrey).
fn leave_one_cluster_out(
    samples: &[LateralSample],
    model: &MagicFormula,
    free: [bool; 3],
    slip_sd: f64,
) -> Result<Matrix3<f64>, Error> {
    let clusters = by_cluster(samples, model, slip_sd);
    let count = clusters.len() as f64;
    let total = clusters
        .values()
        .copied()
        .fold(Score::default(), Score::add);
    let mut covariance = Matrix3::zeros();
    for cluster in clusters.values() {
        let rest = total.slope - cluster.slope;
        let Some(change) = step(&rest, &cluster.score, free) else {
            return Err(Error::Undetermined {
                what: "the fit without one of its runs",
                ratio: 0.0,
            });
        };
        covariance += change * change.transpose();
    }
    Ok(covariance * ((count - 1.0) / count))
}
