//! Fit of the magic formula to measured slip angles, loads and lateral forces.
//!
//! Ordinary least squares takes the slip angle for exact. It is not: noise in it flattens the fitted curve (attenuation) and
//! no amount of data helps. The fit therefore starts from least squares (Levenberg-Marquardt) and goes on to the root of
//! a corrected score that is unbiased for slip noise of a stated standard deviation. Intervals come from leaving out
//! one cluster (run) at a time, so that correlation within a run does not make them too narrow.

use nalgebra::Matrix3;

use crate::friction::error::{Error, in_range};
use crate::friction::estimate::{Estimate, student_quantile};
use crate::friction::lateral::identifiability::{Combination, Identifiability};
use crate::friction::lateral::law::MagicFormula;
use crate::friction::lateral::least_squares::least_squares;
use crate::friction::lateral::options::LateralFitOptions;
use crate::friction::lateral::root::{
    by_cluster, choose_freedom, corrected_root, leave_one_cluster_out,
};
use crate::friction::lateral::score::{LateralSample, model_of};

/// The fitted model and what is known of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct LateralFit {
    /// The model with attenuation corrected.
    pub model: MagicFormula,
    /// Cornering stiffness K [N/rad].
    pub k_n_per_rad: Estimate,
    /// The product of mu_zeta and C, which saturation determines.
    pub mu_zeta_c: Estimate,
    /// mu_zeta; conditional on C where C is held.
    pub mu_zeta: Estimate,
    /// Shape factor C.
    pub c: Estimate,
    /// Whether C was held at the options' value because the data do not determine it.
    pub c_held: bool,
    /// Whether the data saturate enough to determine the product; if not, its interval is 0 to infinity and only K counts.
    pub product_determined: bool,
    /// Covariance of `(ln K, ln(mu_zeta C), ln C)`; zero rows where C is held.
    pub covariance: Matrix3<f64>,
    /// What the data determine, judged with all three free.
    pub identifiability: Identifiability,
    /// Plain least squares, which slip noise biases.
    pub least_squares: MagicFormula,
    /// K of plain least squares over the corrected K.
    pub attenuation: f64,
    /// Slip noise that was corrected for [rad].
    pub slip_sd: f64,
    /// Root mean square of the residual force [N].
    pub residual_rms: f64,
    /// Samples used.
    pub samples: usize,
    /// Samples left out: lifted, or so lightly loaded that slip noise spans the whole curve.
    pub left_out: usize,
    /// Clusters that the intervals rest on.
    pub clusters: usize,
}

/// Fewest samples a fit accepts.
const FEWEST: usize = 20;
/// Factor on the product beyond which the data lie on the straight part of the curve.
const STRAIGHT: f64 = 1e4;
/// Largest shift of the scaled slip into the complex plane; the nearest singularity is at 1.
const LARGEST_SHIFT: f64 = 0.5;

/// Fits the magic formula with predefined E to one runner's samples.
///
/// Where all samples are one cluster it is cut into twenty stretches in the order given.
///
/// # Errors
/// [`Error::TooFew`], [`Error::OutOfRange`] for NaN or options out of range, [`Error::Undetermined`] where not even K is
/// determined or slip noise exceeds the slip, [`Error::NotConverged`].
pub fn fit_lateral(
    samples: &[LateralSample],
    options: &LateralFitOptions,
) -> Result<LateralFit, Error> {
    check(samples, options)?;
    let mut used: Vec<LateralSample> = samples.iter().copied().filter(|s| s.fz > 0.0).collect();
    need(used.len())?;
    cut_single_cluster(&mut used);
    let start = first_guess(&used, options)?;
    let held = [true, true, false];
    let mut rough = least_squares(&used, start, held)?;
    if options.slip_sd > 0.0 {
        let reach =
            3f64.sqrt() * options.slip_sd * rough.k_n_per_rad / (rough.mu_zeta_c() * LARGEST_SHIFT);
        let loaded: Vec<LateralSample> = used.iter().copied().filter(|s| s.fz > reach).collect();
        if loaded.len() < used.len() {
            need(loaded.len())?;
            used = loaded;
            rough = least_squares(&used, rough, held)?;
        }
    }
    let (mut free, least_squares_model, identifiability) = choose_freedom(&used, rough, options)?;
    let attempt = |start: &MagicFormula, free: [bool; 3]| {
        let theta = corrected_root(&used, start, free, options)?;
        let model = model_of(&theta, options.e);
        let covariance = leave_one_cluster_out(&used, &model, free, options.slip_sd)?;
        Ok((theta, model, covariance))
    };
    let both = attempt(&least_squares_model, free);
    let product_determined =
        matches!(&both, Ok((_, _, covariance)) if covariance[(1, 1)].sqrt() < Combination::LIMIT);
    // Where the best product is infinite the curve is a straight line, and K is fitted alone.
    let (theta, model, covariance) = match both {
        Ok(both) => both,
        Err(Error::Undetermined { .. } | Error::NotConverged { .. }) => {
            free = [true, false, false];
            let straight = MagicFormula {
                mu_zeta: STRAIGHT * least_squares_model.mu_zeta,
                ..least_squares_model
            };
            attempt(&straight, free)?
        }
        Err(other) => return Err(other),
    };
    let clusters = by_cluster(&used, &model, options.slip_sd).len();
    let quantile = student_quantile(options.confidence, clusters - 1);
    let estimate = |log: f64, variance: f64| {
        let half = quantile * variance.max(0.0).sqrt();
        Estimate {
            value: log.exp(),
            low: (log - half).exp(),
            high: (log + half).exp(),
        }
    };
    let or_unknown = |estimate: Estimate| match product_determined {
        true => estimate,
        false => Estimate {
            low: 0.0,
            high: f64::INFINITY,
            ..estimate
        },
    };
    let mu_zeta_variance = covariance[(1, 1)] + covariance[(2, 2)] - 2.0 * covariance[(1, 2)];
    let squares: f64 = used
        .iter()
        .map(|s| (s.fy - model.force(s.alpha, s.fz)).powi(2))
        .sum();
    Ok(LateralFit {
        model,
        k_n_per_rad: estimate(theta[0], covariance[(0, 0)]),
        mu_zeta_c: or_unknown(estimate(theta[1], covariance[(1, 1)])),
        mu_zeta: or_unknown(estimate(theta[1] - theta[2], mu_zeta_variance)),
        c: estimate(theta[2], covariance[(2, 2)]),
        c_held: !free[2],
        product_determined,
        covariance,
        identifiability,
        least_squares: least_squares_model,
        attenuation: least_squares_model.k_n_per_rad / model.k_n_per_rad,
        slip_sd: options.slip_sd,
        residual_rms: (squares / used.len() as f64).sqrt(),
        samples: used.len(),
        left_out: samples.len() - used.len(),
        clusters,
    })
}

fn need(have: usize) -> Result<(), Error> {
    if have >= FEWEST {
        return Ok(());
    }
    Err(Error::TooFew {
        what: "lateral fit: samples with enough load".into(),
        have,
        need: FEWEST,
    })
}

fn check(samples: &[LateralSample], options: &LateralFitOptions) -> Result<(), Error> {
    in_range("e", options.e, options.e <= 1.0, "at most 1")?;
    let c = options.c > 0.0 && options.c < 2.0;
    in_range("c", options.c, c, "above 0, below 2")?;
    let slip_sd = (0.0..0.1).contains(&options.slip_sd);
    in_range("slip_sd", options.slip_sd, slip_sd, "0 to 0.1 rad")?;
    let confidence = options.confidence > 0.0 && options.confidence < 1.0;
    in_range(
        "confidence",
        options.confidence,
        confidence,
        "above 0, below 1",
    )?;
    for sample in samples {
        let slip = sample.alpha.abs() < std::f64::consts::FRAC_PI_2;
        in_range(
            "slip angle",
            sample.alpha,
            slip,
            "radians within a quarter turn",
        )?;
        in_range("normal force", sample.fz, true, "a finite force [N]")?;
        in_range("lateral force", sample.fy, true, "a finite force [N]")?;
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

/// K from a straight line through the origin, the product from the largest friction used.
fn first_guess(
    samples: &[LateralSample],
    options: &LateralFitOptions,
) -> Result<MagicFormula, Error> {
    let slip_square: f64 = samples.iter().map(|s| s.alpha * s.alpha).sum();
    let true_square = slip_square - samples.len() as f64 * options.slip_sd * options.slip_sd;
    if true_square <= 0.02 * slip_square {
        return Err(Error::Undetermined {
            what: "cornering stiffness K (the slip is within its noise)",
            ratio: if slip_square > 0.0 {
                (true_square / slip_square).max(0.0)
            } else {
                0.0
            },
        });
    }
    let product: f64 = samples.iter().map(|s| s.alpha * s.fy).sum();
    let mut friction: Vec<f64> = samples.iter().map(|s| (s.fy / s.fz).abs()).collect();
    friction.sort_by(f64::total_cmp);
    let p = friction[friction.len() * 9 / 10].max(1e-6);
    let k_n_per_rad = product / true_square;
    in_range(
        "cornering stiffness of a straight line",
        k_n_per_rad,
        k_n_per_rad > 0.0,
        "positive: check the signs of slip and force",
    )?;
    Ok(MagicFormula {
        mu_zeta: p / options.c,
        c: options.c,
        e: options.e,
        k_n_per_rad,
    })
}
