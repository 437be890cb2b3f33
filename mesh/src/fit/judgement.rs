//! How well a fitted surface follows its hull, and what that is fine enough for.

use crate::fit::fitted_underside::Surface;
use crate::fit::spline::{Bicubic, Sample};
use crate::parameter::linspace;
use crate::shapes::underside::Underside;

/// Heights over the keel within which the fit is judged [m].
const JUDGED_HEIGHT: f64 = 50e-6;

/// Stations along and across at which the fit is judged.
pub(crate) const STATIONS: usize = 400;

/// How well a fitted underside follows its hull near the keel (up to 50 µm above it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitQuality {
    /// Root mean square distance of the vertices [m].
    pub residual_rms: f64,
    /// Largest distance of a vertex [m].
    pub residual_max: f64,
    /// Vertices that the figures come from.
    pub vertices: usize,
    /// Estimated error between the vertices [m]: what halving the number of knots changes.
    pub resolution_error: f64,
    /// Knot intervals along x and across.
    pub intervals: [usize; 2],
}

/// A hull too coarse for its load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarse {
    /// Estimated error of the fitted height where the hull touches [m].
    pub error: f64,
    /// Largest error allowed [m].
    pub allowed: f64,
}

impl Coarse {
    /// That `error` is more than `allowed` [m].
    pub(crate) fn over(error: f64, allowed: f64) -> Option<Self> {
        (error > allowed).then_some(Self { error, allowed })
    }
}

/// By how much noise times spacing, or without noise the spacing, is to shrink for a fit's error to
/// shrink by `factor`.
///
/// The error of a smooth surface fitted to n vertices with noise goes as
/// (noise / sqrt(n))^(2p/(2p + d)), p = 4 for cubic splines, d = 2 (C.J. Stone, Ann. Statist. 10,
/// 1040, 1982), and n as one over the spacing squared: as (noise times spacing)^(4/5). Without noise it goes as the fourth
/// power of the spacing.
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
}

impl Judgement {
    /// Finds the keel of `surface`, moves its lowest point to height 0 and measures the fit near
    /// the keel; `coarser` is the fit with half the knots.
    pub fn of(surface: &mut Surface, samples: &[Sample], coarser: &Bicubic, noise: f64) -> Self {
        let [x0, x1, y0, y1] = surface.extent;
        let mut checks = Vec::new();
        let mut quality = FitQuality {
            residual_rms: 0.0,
            residual_max: 0.0,
            vertices: 0,
            resolution_error: 0.0,
            intervals: [0, 1].map(|axis| surface.spline.axes[axis].breaks().len() - 1),
        };
        let mut ys: Vec<f64> = linspace(y0, y1, STATIONS).collect();
        // Four places in each interval across as well; intervals may be short.
        let breaks = surface.spline.axes[1].breaks().to_vec();
        ys.extend(
            breaks
                .windows(2)
                .flat_map(|b| [0.0, 0.25, 0.5, 0.75].map(|p| b[0] + p * (b[1] - b[0])))
                .map(|t| {
                    let (mut low, mut high) = (y0, y1);
                    for _ in 0..50 {
                        let middle = 0.5 * (low + high);
                        if surface.arc_length.value(middle) < t {
                            low = middle
                        } else {
                            high = middle
                        }
                    }
                    0.5 * (low + high)
                }),
        );
        ys.sort_by(f64::total_cmp);
        let mut keel = vec![f64::INFINITY; STATIONS + 1];
        let stations: Vec<f64> = linspace(x0, x1, STATIONS).collect();
        for (&x, keel) in stations.iter().zip(&mut keel) {
            *keel = ys
                .iter()
                .map(|&y| surface.height(x, y))
                .fold(f64::INFINITY, f64::min);
        }
        surface.level = keel.iter().copied().fold(f64::INFINITY, f64::min);
        for (&x, keel) in stations.iter().zip(&keel) {
            for &y in &ys {
                let height = surface.height(x, y);
                if height.is_finite() && height + surface.level <= keel + JUDGED_HEIGHT {
                    let change = surface.spline_height(x, y)
                        - coarser.value([x, surface.arc_length.value(y)]);
                    checks.push(Check {
                        x,
                        y,
                        height,
                        error: change.abs(),
                    });
                }
            }
        }
        quality.resolution_error = checks.iter().map(|c| c.error).fold(0.0, f64::max);
        let (mut sum, mut count) = (0.0, 0usize);
        for sample in samples {
            let place = (sample.at[0] - x0) / (x1 - x0) * STATIONS as f64;
            let i = (place.round() as usize).min(STATIONS);
            if sample.height <= keel[i] + JUDGED_HEIGHT + 3.0 * noise {
                let residual = sample.weight * (surface.spline.value(sample.at) - sample.height);
                sum += residual * residual;
                count += 1;
                quality.residual_max = quality.residual_max.max(residual.abs());
            }
        }
        quality.vertices = count;
        quality.residual_rms = (sum / count.max(1) as f64).sqrt();
        // Noise leaves its standard error in the fit; what exceeds the stated noise is misfit.
        let unknowns = surface.spline.coefficients.len() as f64;
        let standard_error = noise * (unknowns / samples.len() as f64).min(1.0).sqrt();
        let misfit = (quality.residual_rms.powi(2) - noise * noise)
            .max(0.0)
            .sqrt();
        let scatter = standard_error.hypot(misfit);
        checks
            .iter_mut()
            .for_each(|c| c.error = c.error.hypot(scatter));
        Self { quality, checks }
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
