//! One gliding run: its energies over the distance, and the resistance from their slope.

use crate::error::{Error, in_range};
use crate::friction::specimens::{GlideEntry, GlideTrace, integrate};
use crate::series::root_mean_square;

/// Specific gas constant of dry air [J/(kg K)].
const GAS_CONSTANT_OF_AIR: f64 = 287.05;
/// Acceleration of gravity in all formats: the reading of an accelerometer at rest on level ice
/// [m/s2].
pub const GRAVITY: f64 = 9.81;
/// Share of the glided distance at each end that is not used: there the athlete lies down or sits
/// up.
pub const SHARE_LEFT_OUT: f64 = 0.2;

/// Air density [kg/m3]: `rho = p / (R T)` with the specific gas constant of air and T in kelvin.
///
/// ```
/// assert!((kufe_sled::friction::air_density(94_700.0, 2.0) - 1.199).abs() < 1e-3);
/// ```
pub fn air_density(air_pa: f64, air_c: f64) -> f64 {
    air_pa / (GAS_CONSTANT_OF_AIR * (air_c + 273.15))
}

/// One evaluated run.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideRun {
    /// Its row of the index.
    pub entry: GlideEntry,
    /// Distance from the start of the glide [m].
    pub s: Vec<f64>,
    /// Kinetic energy [J].
    pub kinetic: Vec<f64>,
    /// Work of the air drag since the start of the glide [J].
    pub aero: Vec<f64>,
    /// Samples of the middle section.
    pub section: std::ops::Range<usize>,
    /// Line fitted to kinetic energy plus work of the air drag over the distance, in the middle
    /// section.
    pub line: LineFit,
    /// Mean speed in the middle section [m/s].
    pub v_mean: f64,
    /// Air density [kg/m3].
    pub air_density: f64,
}

impl GlideRun {
    /// Ratio of ice friction plus the downhill component of the weight to the weight:
    /// `mu cos(kappa) +- sin(kappa)`.
    pub fn resistance(&self) -> f64 {
        -self.line.slope / (self.entry.conditions.mass_kg * GRAVITY)
    }

    /// Standard error of [`GlideRun::resistance`].
    pub fn resistance_se(&self) -> f64 {
        self.line.slope_se / (self.entry.conditions.mass_kg * GRAVITY)
    }
}

/// Evaluates one run.
///
/// ```text
/// E_kin = m v^2 / 2,   W_aero(s) = integral of c_d A rho v^2 / 2 ds,   F = -d(E_kin + W_aero)/ds
/// ```
///
/// Kinetic energy that the air does not take goes into ice friction and, on a slope, into height.
/// The line is fitted over the middle section: the glide starts at the largest speed (mean over
/// half a second), and the central 60 % of the distance from there to the end is used.
///
/// # Errors
/// [`Error::TooFew`] below thirty samples in the section, [`Error::OutOfRange`] for a glide shorter
/// than 1 m or one that accelerates.
pub fn evaluate_glide(entry: &GlideEntry, trace: &GlideTrace) -> Result<GlideRun, Error> {
    const MIN_SAMPLES: usize = 30;
    let start = fastest(trace);
    let (t, v) = (&trace.t[start..], &trace.v[start..]);
    let glided = trace.s[start..].iter().map(|s| s - trace.s[start]);
    let s: Vec<f64> = glided.collect();
    let total_m = s.iter().copied().fold(0.0, f64::max);
    let is_long = total_m >= 1.0;
    in_range("distance glided [m]", total_m, is_long, "at least 1 m")?;
    let density = entry.conditions.air_density();
    let over_square = |factor: f64| v.iter().map(|v| factor * v * v).collect::<Vec<f64>>();
    let kinetic = over_square(0.5 * entry.conditions.mass_kg);
    let drag = over_square(0.5 * entry.cda_m2 * density);
    let aero = if trace.s_measured {
        integrate(&s, &drag)
    } else {
        let power: Vec<f64> = drag.iter().zip(v).map(|(f, v)| f * v).collect();
        integrate(t, &power)
    };
    let first_at = |share: f64| {
        let index = s.iter().position(|s| *s >= share * total_m);
        index.unwrap_or(s.len())
    };
    let section = first_at(SHARE_LEFT_OUT)..first_at(1.0 - SHARE_LEFT_OUT);
    if section.len() < MIN_SAMPLES {
        let what = format!("run {}: samples in the middle section", entry.run);
        return Err(Error::too_few(what, section.len(), MIN_SAMPLES));
    }
    let line_of = |energy: Vec<f64>| fit_line(&s[section.clone()], &energy);
    let kinetic_line = line_of(kinetic[section.clone()].to_vec());
    let line = line_of(section.clone().map(|i| kinetic[i] + aero[i]).collect());
    let (Some(kinetic_line), Some(line)) = (kinetic_line, line) else {
        return Err(Error::OutOfRange {
            name: "distance glided in the middle section [m]",
            value: 0.0,
            expected: "a positive distance",
        });
    };
    // Within six standard errors a glide on a level rink may seem to accelerate.
    let force = kinetic_line.slope;
    let slows = force <= MIN_PUSH_N.max(6.0 * kinetic_line.slope_se);
    let expected =
        "a negative force, of a glide that slows down: this one accelerates in its middle section";
    in_range("force along the glide [N]", force, slows, expected)?;
    Ok(GlideRun {
        entry: entry.clone(),
        v_mean: v[section.clone()].iter().sum::<f64>() / section.len() as f64,
        s,
        kinetic,
        aero,
        section,
        line,
        air_density: density,
    })
}

/// Accelerating force [N] up to which a glide is accepted: a tenth of the ice friction of the
/// lightest rider.
const MIN_PUSH_N: f64 = 0.3;

/// Index of the first sample of the half second with the largest mean speed.
fn fastest(trace: &GlideTrace) -> usize {
    let distance = integrate(&trace.t, &trace.v);
    let mut best = (0, f64::NEG_INFINITY);
    let mut end = 0;
    for start in 0..trace.t.len() {
        while end + 1 < trace.t.len() && trace.t[end] - trace.t[start] < 0.5 {
            end += 1;
        }
        let span = trace.t[end] - trace.t[start];
        if span < 0.5 {
            break;
        }
        let speed = (distance[end] - distance[start]) / span;
        if speed > best.1 {
            best = (start, speed);
        }
    }
    best.0
}

/// A fitted line `y = level + slope (x - centre)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// Slope.
    pub slope: f64,
    /// Standard error of the slope.
    pub slope_se: f64,
    /// Mean of x.
    pub centre: f64,
    /// Value at the mean of x.
    pub level: f64,
    /// Root mean square of the residuals.
    pub residual_rms: f64,
}

impl LineFit {
    /// Value of the line at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.level + self.slope * (x - self.centre)
    }
}

/// Fits a line to points in the order of measurement, by least squares.
///
/// The standard error is that of Andrews and Monahan (Econometrica 60 (1992) 953): the products of
/// the deviation in x and the residual are whitened by a first-order autoregression (its
/// coefficient r corrected by `(1 + 4 r)/n` after Kendall, Biometrika 41 (1954) 403, and limited to
/// below 0.999), their long-run variance is taken with Bartlett weights over `4 (n/100)^(2/9)`
/// lags, and coloured back. It is too small if errors are correlated over more than about a tenth
/// of the points. `None` below three points or without spread in x.
pub fn fit_line(x: &[f64], y: &[f64]) -> Option<LineFit> {
    let n = x.len() as f64;
    let centre = x.iter().sum::<f64>() / n;
    let level = y.iter().sum::<f64>() / n;
    let spread: f64 = x.iter().map(|x| (x - centre).powi(2)).sum();
    if x.len() < 3 || x.len() != y.len() || spread.is_nan() || spread <= 0.0 {
        return None;
    }
    let deviation = || x.iter().map(|x| x - centre);
    let products = deviation().zip(y).map(|(x, y)| x * (y - level));
    let slope = products.sum::<f64>() / spread;
    let residuals = deviation().zip(y).map(|(x, y)| y - level - slope * x);
    let residual: Vec<f64> = residuals.collect();
    let product: Vec<f64> = deviation().zip(&residual).map(|(x, r)| x * r).collect();
    let variance = long_run_variance(&product) * n / (n - 2.0);
    Some(LineFit {
        slope,
        slope_se: (n * variance).sqrt() / spread,
        centre,
        level,
        residual_rms: root_mean_square(residual.iter().copied()),
    })
}

/// Long-run variance of a series of mean zero.
fn long_run_variance(u: &[f64]) -> f64 {
    const LIMIT: f64 = 0.999;
    let product_at = |w: &[f64], lag: usize| -> f64 {
        w.iter().zip(&w[lag..]).map(|(a, b)| a * b).sum::<f64>() / w.len() as f64
    };
    let variance_at_0 = product_at(u, 0);
    if variance_at_0 == 0.0 {
        return 0.0;
    }
    let estimate = product_at(u, 1) / variance_at_0;
    let r = (estimate + (1.0 + 4.0 * estimate.max(0.0)) / u.len() as f64).clamp(-LIMIT, LIMIT);
    let white: Vec<f64> = u.windows(2).map(|pair| pair[1] - r * pair[0]).collect();
    let lags = (4.0 * (white.len() as f64 / 100.0).powf(2.0 / 9.0)) as usize;
    let lags = lags.min(white.len() - 1);
    let mut variance = product_at(&white, 0);
    for lag in 1..=lags {
        let weight = 1.0 - lag as f64 / (lags as f64 + 1.0);
        variance += 2.0 * weight * product_at(&white, lag);
    }
    variance / (1.0 - r).powi(2)
}
