//! Quality of a fitted surface: residuals, estimated errors and outliers.

use crate::fit::fitted_underside::Surface;
use crate::fit::spline::{Bicubic, Sample};
use crate::parameter::linspace;
use crate::shapes::underside::Underside;

/// Heights over the keel within which the fit is judged [m].
const JUDGED_HEIGHT: f64 = 50e-6;

/// Stations along and across at which the fit is judged.
pub(crate) const STATIONS: usize = 400;

/// Quality of a fitted underside near the keel (up to 50 µm above it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitQuality {
    /// Root mean square distance of the vertices [m].
    pub residual_rms: f64,
    /// Largest distance of a vertex [m].
    pub residual_max: f64,
    /// Number of vertices that the figures come from.
    pub vertices: usize,
    /// Estimated error between the vertices [m]: the change by halving the number of knots.
    pub resolution_error: f64,
    /// Knot intervals along x and across.
    pub intervals: [usize; 2],
    /// Number of vertices of the whole underside that are farther from the surface than six
    /// standard deviations of the noise; 0 without noise.
    pub outliers: usize,
    /// The farthest outlier: its x and its distance [m].
    pub farthest: [f64; 2],
}

/// Smallest ratio of an outlier's distance to the standard deviation of the noise: of a million
/// normal values none is as far.
const OUTLIER: f64 = 6.0;
/// Largest fraction of outliers among the vertices; more of them mean that the fit does not follow
/// the surface.
const MAX_OUTLIERS: f64 = 0.01;

impl FitQuality {
    /// Warning about a scan with outliers; `None` without.
    pub fn outliers_warning(&self) -> Option<String> {
        let Self {
            outliers,
            farthest: [x, distance],
            ..
        } = *self;
        (outliers > 0).then(|| {
            format!(
                "outliers: {outliers} vertices of the underside lie more than six standard deviations of the noise off the fitted surface, the farthest {:.0} µm at x = {:.1} mm; remove them from the scan",
                1e6 * distance,
                1e3 * x
            )
        })
    }
}

/// Factor by which noise times spacing, or without noise the spacing, must decrease for the error
/// of a fit to decrease by `factor`.
///
/// The error of a smooth surface fitted to n vertices with noise is proportional to (noise /
/// sqrt(n))^(2p/(2p + d)), p = 4 for cubic splines, d = 2 (C.J. Stone, Ann. Statist. 10, 1040,
/// 1982). n is proportional to 1 / spacing^2, so the error is proportional to (noise times
/// spacing)^(4/5). Without noise it is proportional to the fourth power of the spacing.
pub fn smaller_by(factor: f64, noisy: bool) -> f64 {
    factor.powf(if noisy { 1.25 } else { 0.25 })
}

/// The fit's estimated error at a place on the keel.
#[derive(Clone, Copy, Debug)]
struct Check {
    x: f64,
    y: f64,
    height: f64,
    error: f64,
}

/// The fit's quality, and its error along the keel.
#[derive(Clone, Debug)]
pub(crate) struct Judgement {
    /// Figures near the keel.
    pub quality: FitQuality,
    checks: Vec<Check>,
    /// Vertices near the keel: x and the arc length across [m].
    vertices: Vec<[f64; 2]>,
}

impl Judgement {
    /// Finds the keel of `surface`, moves its lowest point to height 0 and measures the fit near
    /// the keel; `coarser` is the fit with half the knots.
    pub fn of(surface: &mut Surface, samples: &[Sample], coarser: &Bicubic, noise: f64) -> Self {
        let [x0, x1, y0, y1] = surface.extent;
        let mut checks = Vec::new();
        // Four places in each knot interval across; intervals may be short.
        let pairs = surface.spline.axes[1].breaks().windows(2);
        let quarters = pairs.flat_map(|b| [0.0, 0.25, 0.5, 0.75].map(|p| b[0] + p * (b[1] - b[0])));
        let between = quarters.map(|length| surface.across(length, 50));
        let mut ys: Vec<f64> = linspace(y0, y1, STATIONS).chain(between).collect();
        ys.sort_by(f64::total_cmp);
        let stations: Vec<f64> = linspace(x0, x1, STATIONS).collect();
        let lowest = |&x: &f64| {
            let heights = ys.iter().map(|&y| surface.height(x, y));
            heights.fold(f64::INFINITY, f64::min)
        };
        let keel: Vec<f64> = stations.iter().map(lowest).collect();
        surface.level = keel.iter().copied().fold(f64::INFINITY, f64::min);
        for (&x, keel) in stations.iter().zip(&keel) {
            for &y in &ys {
                let height = surface.height(x, y);
                if height.is_finite() && height + surface.level <= keel + JUDGED_HEIGHT {
                    let changed = coarser.value([x, surface.arc_length.value(y)]);
                    let error = (surface.spline_height(x, y) - changed).abs();
                    checks.push(Check {
                        x,
                        y,
                        height,
                        error,
                    });
                }
            }
        }
        let is_near = |sample: &&Sample| {
            let place = (sample.at[0] - x0) / (x1 - x0) * STATIONS as f64;
            let station = (place.round() as usize).min(STATIONS);
            sample.height <= keel[station] + JUDGED_HEIGHT + 3.0 * noise
        };
        let residual = |s: &Sample| s.weight * (surface.spline.value(s.at) - s.height);
        let near: Vec<&Sample> = samples.iter().filter(is_near).collect();
        let residuals: Vec<f64> = near.iter().map(|s| residual(s)).collect();
        let mut vertices: Vec<[f64; 2]> = near.iter().map(|s| s.at).collect();
        vertices.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let square = residuals.iter().fold(0.0, |sum, r| sum + r * r);
        let axes = surface.spline.axes.each_ref();
        let distances = samples.iter().map(|s| [s.at[0], residual(s).abs()]);
        let far = |[_, distance]: &[f64; 2]| noise > 0.0 && *distance > OUTLIER * noise;
        let outliers: Vec<[f64; 2]> = distances.filter(far).collect();
        let few = outliers.len() as f64 <= MAX_OUTLIERS * samples.len() as f64;
        let farthest = outliers.iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        let quality = FitQuality {
            residual_rms: (square / residuals.len().max(1) as f64).sqrt(),
            residual_max: residuals.iter().fold(0.0, |most, r| r.abs().max(most)),
            vertices: residuals.len(),
            resolution_error: checks.iter().map(|c| c.error).fold(0.0, f64::max),
            intervals: axes.map(|axis| axis.breaks().len() - 1),
            outliers: if few { outliers.len() } else { 0 },
            farthest: farthest.copied().unwrap_or_default(),
        };
        // Noise contributes its standard error to the fit; residuals above the stated noise are
        // misfit.
        let unknowns = surface.spline.coefficients.len() as f64;
        let standard_error = noise * (unknowns / samples.len() as f64).min(1.0).sqrt();
        let square = quality.residual_rms.powi(2) - noise * noise;
        let scatter = standard_error.hypot(square.max(0.0).sqrt());
        for check in &mut checks {
            check.error = check.error.hypot(scatter);
        }
        Self {
            quality,
            checks,
            vertices,
        }
    }

    /// The longest stretch `[from, to]` of x from `x0` to `x1` without a vertex whose arc length
    /// across is from `t0` to `t1` [m].
    pub fn longest_gap(&self, [x0, x1, t0, t1]: [f64; 4]) -> [f64; 2] {
        let is_within = |[x, t]: &&[f64; 2]| (x0..=x1).contains(x) && (t0..=t1).contains(t);
        let within = self.vertices.iter().filter(is_within).map(|[x, _]| *x);
        let (mut longest, mut from) = ([x0, x0], x0);
        for to in within.chain([x1]) {
            if to - from > longest[1] - longest[0] {
                longest = [from, to];
            }
            from = to;
        }
        longest
    }

    /// The fit's largest estimated error where the height is at most `height` [m].
    pub fn error_below(&self, height: f64) -> f64 {
        self.largest(|check| check.height <= height)
    }

    /// The fit's largest estimated error within `[x_min, x_max, y_min, y_max]` [m].
    pub fn error_within(&self, [x0, x1, y0, y1]: [f64; 4]) -> f64 {
        self.largest(|check| (x0..=x1).contains(&check.x) && (y0..=y1).contains(&check.y))
    }

    fn largest(&self, counts: impl Fn(&Check) -> bool) -> f64 {
        let counted = self.checks.iter().filter(|c| counts(c));
        counted.map(|c| c.error).fold(0.0, f64::max)
    }
}
