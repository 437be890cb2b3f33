//! A smooth underside fitted to the vertices of a tessellated hull.

use std::sync::Arc;

use crate::error::MeshError;
use crate::fit::downward::{Downward, MIN_VERTEX_COSINE, Outline, arc_length};
use crate::fit::judgement::{FitQuality, Judgement, STATIONS};
use crate::fit::knots::{balanced_sides, break_places, refined_fit};
use crate::fit::scans::{Scans, moves, projected_height};
use crate::fit::spline::{Bicubic, Sample, fit};
use crate::hull::triangles::Hull;
use crate::parameter::expect;
use crate::shapes::profile::Profile;
use crate::shapes::underside::{Underside, lows};

/// A smooth height field through the vertices of a hull's downward-facing part.
///
/// A bicubic spline `z = s(x, t(y))` is fitted to the vertices by least squares of their distance
/// along the normal. t(y) is the arc length along the mean section, so that flanks up to upright
/// are resolved; knots are refined, at most to the vertices' own spacing, until the residuals are
/// noise. Facets only define the outline of the hull.
#[derive(Clone, Debug)]
pub struct FittedUnderside {
    surface: Surface,
    /// Fits with every other knot, from the first and from the second on.
    coarser: [Arc<Surface>; 2],
    judgement: Judgement,
    /// Local minima on its own knots.
    lows: Vec<[f64; 2]>,
}

impl FittedUnderside {
    /// Fits the underside of `hull`, whose vertices carry noise of standard deviation `noise` [m]
    /// (0 for a hull made by a computer).
    ///
    /// # Errors
    /// [`MeshError::Value`] for a negative noise or if fewer than 16 vertices face down,
    /// [`MeshError::Invalid`] if none does or they do not determine a surface.
    pub fn new(hull: &Hull, noise: f64) -> Result<Self, MeshError> {
        let (mut surface, samples) = Surface::fit(&Downward::of(hull)?, noise, true)?;
        let halved = |odd: usize| {
            surface.spline.axes.each_ref().map(|axis| {
                let (breaks, last) = (axis.breaks(), axis.breaks().len() - 1);
                let included = |i: &usize| i % 2 == odd || *i == 0 || *i == last;
                let places = (0..=last).filter(included).map(|i| breaks[i]);
                places.collect::<Vec<_>>()
            })
        };
        let [Some(coarser), Some(others)] = [0, 1].map(|odd| fit(&samples, &halved(odd))) else {
            return Err(MeshError::no_fit());
        };
        let judgement = Judgement::of(&mut surface, &samples, &coarser, noise);
        let coarser = [coarser, others].map(|spline| {
            Arc::new(Surface {
                spline,
                ..surface.clone()
            })
        });
        Ok(Self {
            lows: surface.lows(),
            surface,
            coarser,
            judgement,
        })
    }

    /// The fits with every other knot, from the first and from the second on. For a hull without
    /// noise, the change of a contact by the coarser of these fits bounds its error due to the
    /// spacing of the vertices. Two fits are used since one may agree by chance.
    pub fn with_half_the_knots(&self) -> [Arc<dyn Underside>; 2] {
        self.coarser.clone().map(|surface| surface as _)
    }

    /// A synthetic scan of `hull`: its vertices moved vertically onto this surface, plus new noise
    /// of standard deviation `noise` [m] in z.
    ///
    /// Vertices farther from the surface than six standard deviations belong to other parts of the
    /// hull; they only get the noise.
    pub fn scanned(&self, hull: &Hull, noise: f64, seed: u64) -> Hull {
        let mut scanned = hull.clone();
        let moves = moves(noise, seed);
        for ([x, y, z], moved) in scanned.positions.iter_mut().zip(moves) {
            *z = projected_height(&self.surface, [*x, *y, *z], noise) + moved;
        }
        scanned
    }

    /// Synthetic scans as of [`FittedUnderside::scanned`], each fitted on the knots of this fit.
    ///
    /// # Errors
    /// As [`FittedUnderside::new`].
    pub fn scans(&self, hull: &Hull, noise: f64) -> Result<Scans<'_>, MeshError> {
        Scans::new(&self.surface, hull, noise)
    }

    /// Height that is subtracted from the hull's, so that its lowest point lies at 0 [m].
    pub(crate) fn level(&self) -> f64 {
        self.surface.level
    }

    /// The part over the largest rectangle within the outline, so that every column of a solid lies
    /// under the hull. The fit bridges holes and notches of the sides; ragged rims are cut off.
    #[must_use]
    pub fn within_outline(self) -> Self {
        let even = self.surface.symmetric[0];
        let outline = self.surface.outline.clone().bridged();
        let Some(extent) = outline.rectangle(even) else {
            return self;
        };
        let cut = |surface: &Surface| Surface {
            outline: Outline::of_rectangle(extent),
            extent,
            ..surface.clone()
        };
        let surface = cut(&self.surface);
        Self {
            lows: surface.lows(),
            coarser: self.coarser.map(|coarser| Arc::new(cut(&coarser))),
            surface,
            judgement: self.judgement,
        }
    }

    /// Quality of the fit.
    pub fn quality(&self) -> FitQuality {
        self.judgement.quality
    }

    /// The fit's estimated error [m] where the height over the lowest point is at most twice the
    /// `approach` [m].
    pub fn error_for(&self, approach: f64) -> f64 {
        self.judgement.error_below(2.0 * approach)
    }

    /// The fit's estimated error [m] on a contact patch `[x_min, x_max, y_min, y_max]` [m].
    pub fn error_within(&self, patch: [f64; 4]) -> f64 {
        self.judgement.error_within(self.near(patch))
    }

    /// The longest stretch `[from, to]` along a contact patch `[x_min, x_max, y_min, y_max]` in
    /// which the hull has no vertex [m].
    pub fn longest_gap(&self, [x0, x1, y0, y1]: [f64; 4]) -> [f64; 2] {
        let [t0, t1] = [y0, y1].map(|y| self.surface.arc_length.value(y));
        self.judgement.longest_gap([x0, x1, t0, t1])
    }

    /// A patch with a margin of one station along the hull on each side, so that it contains places
    /// at which the fit was judged. The margin applies across, too: heights around a patch that is
    /// narrower than the spacing of vertices bound the curvature in it.
    fn near(&self, [x0, x1, y0, y1]: [f64; 4]) -> [f64; 4] {
        let [a, b, ..] = self.surface.extent;
        let margin = (b - a) / STATIONS as f64;
        [x0 - margin, x1 + margin, y0 - margin, y1 + margin]
    }
}

impl Underside for FittedUnderside {
    fn height(&self, x: f64, y: f64) -> f64 {
        self.surface.height(x, y)
    }

    fn extent(&self) -> [f64; 4] {
        self.surface.extent()
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        self.surface.mirror_symmetric()
    }

    fn lows(&self) -> &[[f64; 2]] {
        &self.lows
    }
}

/// Noise due to single precision in heights over a `range`, and in positions on a slope [m].
pub(crate) fn rounding(range: f64) -> f64 {
    1e-9 + 6e-8 * range
}

/// Makes the spline even along every axis of `mirrored` along which its asymmetry is at most three
/// times the residual and the `noise` [m] together; returns these axes.
fn symmetrise(
    surface: &mut Bicubic,
    samples: &[Sample],
    mirrored: [bool; 2],
    noise: f64,
) -> [bool; 2] {
    let distance = |s: &Sample| s.weight * (surface.value(s.at) - s.height).abs();
    let worst = samples.iter().map(distance).fold(0.0, f64::max);
    let tolerance = 3.0 * worst.max(noise);
    [0, 1].map(|axis| {
        let lopsided = |s: &Sample| {
            let mut image = s.at;
            image[axis] = -image[axis];
            s.weight * (surface.value(s.at) - surface.value(image)).abs()
        };
        // The steepest vertices are supported from one side only.
        let mut gentle = samples
            .iter()
            .filter(|s| s.weight > 3.0 * MIN_VERTEX_COSINE);
        let symmetric = mirrored[axis] && gentle.all(|s| lopsided(s) <= tolerance);
        if symmetric {
            surface.symmetrise(axis);
        }
        symmetric
    })
}

/// The heights z = s(x, t(y)) - level within an outline.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    /// s over x and the arc length.
    pub spline: Bicubic,
    /// t, the arc length along the mean section, over y.
    pub arc_length: Profile,
    /// Outline of the hull.
    pub outline: Outline,
    /// `[x_min, x_max, y_min, y_max]` [m].
    pub extent: [f64; 4],
    /// Height that is subtracted from all heights [m].
    pub level: f64,
    /// Whether it is even in x and in y.
    pub symmetric: [bool; 2],
}

impl Underside for Surface {
    /// Height over the level; infinite where there is no hull.
    fn height(&self, x: f64, y: f64) -> f64 {
        match self.outline.sides(x) {
            Some([from, to]) if (from..=to).contains(&y) => self.spline_height(x, y) - self.level,
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

impl Surface {
    /// Fits the downward-facing part of a hull; returns the surface, with level 0, and the fitted
    /// vertices. A hull whose rotation is not known is never made even.
    ///
    /// # Errors
    /// As [`FittedUnderside::new`].
    pub fn fit(
        part: &Downward,
        noise: f64,
        may_be_even: bool,
    ) -> Result<(Self, Vec<Sample>), MeshError> {
        let usual = noise >= 0.0 && noise.is_finite();
        expect(usual, "noise_m", noise, "0 or a positive number")?;
        let usable = part.gentle().count();
        if usable < 16 {
            let (place, found) = ("the hull's underside", format!("{usable} vertices"));
            return Err(MeshError::value(place, found, "at least 16"));
        }
        let [[x0, x1], [y0, y1], [z0, z1]] = [0, 1, 2].map(|axis| part.range(axis));
        if !(x1 > x0 && y1 > y0) {
            return Err(MeshError::no_fit());
        }
        let centred = |from: f64, to: f64| (from + to).abs() <= 1e-4 * (to - from) + 6.0 * noise;
        let mirrored = [(0, x0, x1), (1, y0, y1)].map(|(axis, from, to)| {
            let places = part.gentle().map(|n| part.points[n][axis]);
            may_be_even && centred(from, to) && balanced_sides(places.collect())
        });
        let widest = |from: f64, to: f64, mirrored: bool| {
            let half = to.max(-from);
            if mirrored { [-half, half] } else { [from, to] }
        };
        let ([x0, x1], [y0, y1]) = (widest(x0, x1, mirrored[0]), widest(y0, y1, mirrored[1]));
        let arc_length = arc_length(part, [y0, y1], mirrored[1]);
        let at = |p: &[f64; 3]| [p[0], arc_length.value(p[1])];
        let samples = part.samples(&arc_length);
        let ends = [[x0, x1], [arc_length.value(y0), arc_length.value(y1)]];
        let candidates = break_places(part, &samples, ends, mirrored, at);
        let floor = rounding(z1 - z0);
        let mut spline = refined_fit(&samples, &candidates, noise.max(floor), mirrored)
            .ok_or_else(MeshError::no_fit)?;
        // Residuals and noise may differ from one side to the other.
        let symmetric = symmetrise(&mut spline, &samples, mirrored, noise.max(floor));
        let surface = Surface {
            spline,
            arc_length,
            outline: part.outline().symmetrised(symmetric),
            extent: [x0, x1, y0, y1],
            level: 0.0,
            symmetric,
        };
        Ok((surface, samples))
    }

    /// Height of the spline [m], within the outline or not.
    pub fn spline_height(&self, x: f64, y: f64) -> f64 {
        let x = if self.symmetric[0] { x.abs() } else { x };
        let y = if self.symmetric[1] { y.abs() } else { y };
        self.spline.value([x, self.arc_length.value(y)])
    }

    /// Local minima on the spline's breaks.
    pub fn lows(&self) -> Vec<[f64; 2]> {
        let [xs, lengths] = self.spline.axes.each_ref().map(|axis| axis.breaks());
        let ys: Vec<f64> = lengths
            .iter()
            .map(|&length| self.across(length, 60))
            .collect();
        lows([xs, &ys], |i, j| self.height(xs[i], ys[j]))
    }

    /// y at an arc length [m], by this number of bisections.
    pub fn across(&self, length: f64, bisections: usize) -> f64 {
        let [_, _, mut low, mut high] = self.extent;
        for _ in 0..bisections {
            let middle = 0.5 * (low + high);
            if self.arc_length.value(middle) < length {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}
