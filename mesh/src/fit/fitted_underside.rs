//! A smooth underside fitted to the vertices of a tessellated hull.

use crate::error::MeshError;
use crate::fit::arc_length::arc_length;
use crate::fit::bicubic::{Bicubic, Sample};
use crate::fit::break_places::break_places;
use crate::fit::downward::{Downward, Outline};
use crate::fit::least_squares::fit;
use crate::fit::refinement::refined_fit;
use crate::hull::triangles::Hull;
use crate::shapes::profile::Profile;
use crate::shapes::underside::Underside;

/// Vertices with a flank steeper than this are left out (cosine of the angle to the ice).
const STEEPEST: f64 = 0.1;
/// Heights over the keel within which the fit is judged [m].
const JUDGED_HEIGHT: f64 = 50e-6;
/// Largest error against the approach with which a hull is fine enough for its load.
const LARGEST_ERROR: f64 = 0.05;

/// A smooth height field through the vertices of a hull's downward-facing part.
///
/// A bicubic spline `z = s(x, t(y))` is fitted to the vertices by least squares of their distance along
/// the normal. t(y) is the arc length along the mean section, so that flanks up to upright are
/// resolved; knots are refined, at most to the vertices' own spacing, until the residuals are
/// noise. Facets only say where the hull is.
#[derive(Clone, Debug)]
pub struct FittedUnderside {
    surface: Bicubic,
    arc_length: Profile,
    outline: Outline,
    extent: [f64; 4],
    level: f64,
    symmetric: [bool; 2],
    quality: FitQuality,
    checks: Vec<Check>,
}

/// How well a fitted underside follows its hull near the keel (up to 50 um above it).
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
    /// The approach that it was judged against [m].
    pub approach: f64,
    /// Largest error allowed [m].
    pub allowed: f64,
}

/// The fit's estimated error at a place on the keel.
#[derive(Clone, Copy, Debug)]
struct Check {
    x: f64,
    y: f64,
    height: f64,
    error: f64,
}

impl FittedUnderside {
    /// Fits the underside of `hull`, whose vertices carry noise of standard deviation `noise` [m] (0 for
    /// a hull made by a computer).
    ///
    /// # Errors
    /// [`MeshError::Parameter`] for a negative noise, [`MeshError::NothingFacesDown`],
    /// [`MeshError::TooFewPoints`] where fewer than 16 vertices face down, [`MeshError::NoFit`] where
    /// they do not determine a surface.
    pub fn new(hull: &Hull, noise: f64) -> Result<Self, MeshError> {
        if !(noise >= 0.0 && noise.is_finite()) {
            return Err(MeshError::Parameter {
                name: "noise_m",
                value: noise,
                expected: "0 or a positive number",
            });
        }
        let part = Downward::of(hull)?;
        let usable = part.cosines.iter().filter(|&&c| c > STEEPEST).count();
        if usable < 16 {
            let name = "vertices of the hull's underside";
            return Err(MeshError::TooFewPoints {
                name,
                found: usable,
                needed: 16,
            });
        }
        let [[x0, x1], [y0, y1], [z0, z1]] = [0, 1, 2].map(|axis| part.range(axis));
        if !(x1 > x0 && y1 > y0) {
            return Err(MeshError::NoFit);
        }
        let centred = |from: f64, to: f64| (from + to).abs() <= 1e-4 * (to - from) + 6.0 * noise;
        let mirrored = [centred(x0, x1), centred(y0, y1)];
        let widest = |from: f64, to: f64, mirrored: bool| {
            let half = to.max(-from);
            if mirrored { [-half, half] } else { [from, to] }
        };
        let ([x0, x1], [y0, y1]) = (widest(x0, x1, mirrored[0]), widest(y0, y1, mirrored[1]));
        let arc_length = arc_length(&part, [y0, y1], mirrored[1]);
        let at = |p: &[f64; 3]| [p[0], arc_length.value(p[1])];
        let samples: Vec<Sample> = part
            .points
            .iter()
            .zip(&part.cosines)
            .filter(|(_, cosine)| **cosine > STEEPEST)
            .map(|(p, &weight)| Sample {
                at: at(p),
                height: p[2],
                weight,
            })
            .collect();
        let ends = [[x0, x1], [arc_length.value(y0), arc_length.value(y1)]];
        let candidates = break_places(&part, &samples, ends, mirrored, at);
        // Single precision of the heights, and of the places on a slope, is noise too.
        let floor = 1e-9 + 6e-8 * (z1 - z0);
        let mut surface = refined_fit(&samples, &candidates, noise.max(floor), mirrored)
            .ok_or(MeshError::NoFit)?;
        let halved = [0, 1].map(|axis| {
            let breaks = surface.axes[axis].breaks();
            let last = breaks.len() - 1;
            (0..=last)
                .filter(|i| i % 2 == 0 || *i == last)
                .map(|i| breaks[i])
                .collect::<Vec<_>>()
        });
        let coarser = fit(&samples, &halved).ok_or(MeshError::NoFit)?;

        let outline = part.outline();
        let mut symmetric = [false; 2];
        let distance =
            |surface: &Bicubic, s: &Sample| s.weight * (surface.value(s.at) - s.height).abs();
        let worst = samples
            .iter()
            .map(|s| distance(&surface, s))
            .fold(0.0, f64::max);
        for axis in 0..2 {
            let mirror = |s: &Sample| {
                if axis == 0 {
                    [-s.at[0], s.at[1]]
                } else {
                    [s.at[0], -s.at[1]]
                }
            };
            let lopsided =
                |s: &Sample| s.weight * (surface.value(s.at) - surface.value(mirror(s))).abs();
            let tolerance = 3.0 * worst.max(noise).max(floor);
            // The steepest vertices are supported from one side only.
            let gentle = samples.iter().filter(|s| s.weight > 3.0 * STEEPEST);
            symmetric[axis] =
                mirrored[axis] && gentle.into_iter().all(|s| lopsided(s) <= tolerance);
            if symmetric[axis] {
                surface.symmetrise(axis);
            }
        }
        let mut underside = Self {
            outline: outline.symmetrised(symmetric),
            extent: [x0, x1, y0, y1],
            level: 0.0,
            symmetric,
            quality: FitQuality {
                residual_rms: 0.0,
                residual_max: 0.0,
                vertices: 0,
                resolution_error: 0.0,
                intervals: [0, 1].map(|axis| surface.axes[axis].breaks().len() - 1),
            },
            checks: Vec::new(),
            surface,
            arc_length,
        };
        underside.judge(&samples, &coarser, noise);
        Ok(underside)
    }

    /// Finds the keel, moves the lowest point to height 0 and measures the fit near the keel.
    fn judge(&mut self, samples: &[Sample], coarser: &Bicubic, noise: f64) {
        const STATIONS: usize = 400;
        let [x0, x1, y0, y1] = self.extent;
        let mut ys: Vec<f64> = (0..=STATIONS)
            .map(|i| y0 + (y1 - y0) * i as f64 / STATIONS as f64)
            .collect();
        // Four places in each interval across as well; intervals may be short.
        let breaks = self.surface.axes[1].breaks().to_vec();
        ys.extend(
            breaks
                .windows(2)
                .flat_map(|b| [0.0, 0.25, 0.5, 0.75].map(|p| b[0] + p * (b[1] - b[0])))
                .map(|t| {
                    let (mut low, mut high) = (y0, y1);
                    for _ in 0..50 {
                        let middle = 0.5 * (low + high);
                        if self.arc_length.value(middle) < t {
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
        let station = |i: usize| x0 + (x1 - x0) * i as f64 / STATIONS as f64;
        for (i, keel) in keel.iter_mut().enumerate() {
            *keel = ys
                .iter()
                .map(|&y| self.height(station(i), y))
                .fold(f64::INFINITY, f64::min);
        }
        self.level = keel.iter().copied().fold(f64::INFINITY, f64::min);
        for (i, keel) in keel.iter().enumerate() {
            let x = station(i);
            for &y in &ys {
                let height = self.height(x, y);
                if height.is_finite() && height + self.level <= keel + JUDGED_HEIGHT {
                    let change =
                        self.surface_height(x, y) - coarser.value([x, self.arc_length.value(y)]);
                    self.checks.push(Check {
                        x,
                        y,
                        height,
                        error: change.abs(),
                    });
                }
            }
        }
        self.quality.resolution_error = self.checks.iter().map(|c| c.error).fold(0.0, f64::max);
        let (mut sum, mut count) = (0.0, 0usize);
        for sample in samples {
            let place = (sample.at[0] - x0) / (x1 - x0) * STATIONS as f64;
            let i = (place.round() as usize).min(STATIONS);
            if sample.height <= keel[i] + JUDGED_HEIGHT + 3.0 * noise {
                let residual = sample.weight * (self.surface.value(sample.at) - sample.height);
                sum += residual * residual;
                count += 1;
                self.quality.residual_max = self.quality.residual_max.max(residual.abs());
            }
        }
        self.quality.vertices = count;
        self.quality.residual_rms = (sum / count.max(1) as f64).sqrt();
        // Noise leaves its standard error in the fit; what exceeds the stated noise is misfit.
        let unknowns = self.surface.coefficients.len() as f64;
        let standard_error = noise * (unknowns / samples.len() as f64).min(1.0).sqrt();
        let misfit = (self.quality.residual_rms.powi(2) - noise * noise)
            .max(0.0)
            .sqrt();
        let scatter = standard_error.hypot(if noise > 0.0 {
            misfit
        } else {
            self.quality.residual_max
        });
        self.checks
            .iter_mut()
            .for_each(|c| c.error = c.error.hypot(scatter));
    }

    /// How well the surface follows the hull.
    pub fn quality(&self) -> FitQuality {
        self.quality
    }

    /// Whether the hull is too coarse, or too noisy, to be pressed in by `approach` [m] on a flat plane:
    /// the fit's estimated error where the height is below twice the approach exceeds a twentieth of it.
    pub fn coarse_for(&self, approach: f64) -> Option<Coarse> {
        self.worst(approach, |check| check.height <= 2.0 * approach)
    }

    /// As [`coarse_for`](Self::coarse_for) for a contact patch `[x_min, x_max, y_min, y_max]` [m] anywhere on the hull.
    pub fn coarse_within(&self, approach: f64, [x0, x1, y0, y1]: [f64; 4]) -> Option<Coarse> {
        let [a, b, ..] = self.extent;
        let margin = (b - a) / 400.0;
        let near = |check: &Check| {
            check.x >= x0 - margin
                && check.x <= x1 + margin
                && check.y >= y0 - margin
                && check.y <= y1 + margin
        };
        self.worst(approach, near)
    }

    fn worst(&self, approach: f64, counts: impl Fn(&Check) -> bool) -> Option<Coarse> {
        let error = self
            .checks
            .iter()
            .filter(|c| counts(c))
            .map(|c| c.error)
            .fold(0.0, f64::max);
        let allowed = LARGEST_ERROR * approach;
        (error > allowed).then_some(Coarse {
            error,
            approach,
            allowed,
        })
    }

    fn surface_height(&self, x: f64, y: f64) -> f64 {
        let x = if self.symmetric[0] { x.abs() } else { x };
        let y = if self.symmetric[1] { y.abs() } else { y };
        self.surface.value([x, self.arc_length.value(y)])
    }
}

impl Underside for FittedUnderside {
    fn height(&self, x: f64, y: f64) -> f64 {
        match self.outline.sides(x) {
            Some([from, to]) if (from..=to).contains(&y) => self.surface_height(x, y) - self.level,
            _ => f64::INFINITY,
        }
    }

    fn extent(&self) -> [f64; 4] {
        self.extent
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        self.symmetric
    }
}
