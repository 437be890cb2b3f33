//! A first guess of the patch from the undeformed gap alone.

use kufe_mesh::Underside;

use crate::Load;
use crate::bisection::{bisect, bisect_scales};
use crate::grid::patch::{Patch, corners};
use crate::grid::stretch::Stretch;
use crate::problem::check::CheckedProblem;
use crate::problem::gap::Gap;

/// Guesses the patch: the part of the hull below a cut at depth d, with d such that the load is E*
/// d (length width)^(1/2). This is the load of a Hertz contact to within a factor of 2.
pub(crate) fn first_guess(problem: &CheckedProblem) -> Patch {
    guess(problem, &|_, _| f64::INFINITY)
}

/// [`first_guess`] with a largest load [N] of a cut as a function of its length and width [m],
/// `most`.
fn guess(problem: &CheckedProblem, most: &dyn Fn(f64, f64) -> f64) -> Patch {
    let CheckedProblem { problem, gap, .. } = problem;
    let contact_modulus = problem.ice.youngs_modulus / (1.0 - problem.ice.poissons_ratio.powi(2));
    let underside = problem.runner.underside.as_ref();
    let stations = Stations::new(underside, gap);
    let guess = match problem.load {
        Load::Approach { approach, .. } => stations.cut(gap, approach.max(1e-12)),
        Load::Force { fz, .. } => {
            let [low, high] = bisect([1e-12f64.ln(), 1.0f64.ln()], 60, |middle| {
                let depth = middle.exp();
                let patch = stations.cut(gap, depth);
                let length: f64 = patch.x.iter().map(|s| 2.0 * s.half()).sum();
                let width = 2.0 * patch.y.half();
                let elastic = contact_modulus * depth * (length * width).sqrt();
                elastic.min(most(length, width)) < fz
            });
            stations.cut(gap, (0.5 * (low + high)).exp())
        }
    };
    let y = gap.line_of_action[1];
    let corners = match &problem.ice_surface {
        None => corners(|x, y| underside.height(x, y), underside.extent(), y),
        // The ice may have corners too, and under an unbounded hull the guess alone bounds the
        // search.
        Some(_) => corners(|x, y| gap.at(x, y), within(&guess, underside.extent()), y),
    };
    Patch { corners, ..guess }.refined_at_corners()
}

/// The hull's extent; for an unbounded hull along x three times the expected patch.
fn within(guess: &Patch, [low, high, right, left]: [f64; 4]) -> [f64; 4] {
    if low.is_finite() && high.is_finite() {
        return [low, high, right, left];
    }
    let [from, to] = guess.span_x();
    [2.0 * from - to, 2.0 * to - from, right, left]
}

/// Sampled lines along and across the hull.
struct Stations {
    along: Vec<[f64; 2]>,
    lowest: f64,
    y0: f64,
    y_range: [f64; 2],
}

impl Stations {
    /// Samples the gap on the line along x through the line of action, denser near it.
    fn new(underside: &dyn Underside, gap: &Gap) -> Self {
        let extent = underside.extent();
        let [x0, y0] = gap.line_of_action;
        let reach = |end: f64, from: f64| {
            if end.is_finite() {
                end - from
            } else {
                end.signum() * 2.0
            }
        };
        let (back, front) = (reach(extent[0], x0), reach(extent[1], x0));
        let mut offsets: Vec<f64> = Vec::new();
        for i in 0..=400 {
            let t = i as f64 / 400.0;
            offsets.push(front * t.powi(3));
            offsets.push(back * t.powi(3));
            offsets.push(front * t);
            offsets.push(back * t);
        }
        offsets.sort_by(f64::total_cmp);
        offsets.dedup();
        let end = |end: f64, otherwise: f64| if end.is_finite() { end } else { otherwise };
        let y_range = [end(extent[2], y0 - 2.0), end(extent[3], y0 + 2.0)];
        let stations = offsets.iter().map(|d| x0 + d);
        let along: Vec<[f64; 2]> = stations
            .map(|x| [x, lowest_across(gap, x, y0, y_range)])
            .filter(|s| s[1].is_finite())
            .collect();
        let lowest = along.iter().map(|s| s[1]).fold(f64::INFINITY, f64::min);
        let along = along.iter().map(|s| [s[0], s[1] - lowest]).collect();
        Stations {
            along,
            lowest,
            y0,
            y_range,
        }
    }

    /// The part of the hull within `depth` of its lowest point.
    fn cut(&self, gap: &Gap, depth: f64) -> Patch {
        let below = |s: &[f64; 2]| s[1] < depth;
        let crossing = |[from, to]: [[f64; 2]; 2]| {
            from[0] + (to[0] - from[0]) * (depth - from[1]) / (to[1] - from[1])
        };
        let mut x = Vec::new();
        let mut next = 0;
        while let Some(first) = (next..self.along.len()).find(|&k| below(&self.along[k])) {
            let end = (first..self.along.len()).find(|&k| !below(&self.along[k]));
            let last = end.map_or(self.along.len() - 1, |end| end - 1);
            let low = match first {
                0 => self.along[0][0],
                _ => crossing([self.along[first - 1], self.along[first]]),
            };
            let high = match end {
                Some(end) => crossing([self.along[last], self.along[end]]),
                None => self.along[last][0],
            };
            x.extend((low < high).then(|| Stretch::even(low, high)));
            next = last + 1;
        }
        let stations = self.along.iter();
        let deepest = stations.min_by(|a, b| a[1].total_cmp(&b[1]));
        let deepest = deepest.map_or(0.0, |s| s[0]);
        let width = |sign: f64| {
            let end = self.y_range[usize::from(sign > 0.0)] - self.y0;
            let below = |d: f64| gap.at(deepest, self.y0 + d) - self.lowest < depth;
            let ends = [1e-9f64.min(end.abs()), end.abs()];
            if below(sign * ends[1]) {
                return end;
            }
            let [_, high] = bisect_scales(ends, 60, |middle| below(sign * middle));
            sign * high
        };
        let y = Stretch::even(self.y0 + width(-1.0), self.y0 + width(1.0));
        Patch {
            x,
            y,
            motion: depth + self.lowest,
            corners: Vec::new(),
        }
    }
}

/// Gap at (`x`, `y0`); if there is no hull, the lowest of 39 points on the line across over `range`
/// [m].
fn lowest_across(gap: &Gap, x: f64, y0: f64, range: [f64; 2]) -> f64 {
    let here = gap.at(x, y0);
    if here.is_finite() {
        return here;
    }
    (1..40)
        .map(|i| gap.at(x, range[0] + (range[1] - range[0]) * f64::from(i) / 40.0))
        .fold(f64::INFINITY, f64::min)
}

// Patches of a sliding runner: a first guess, and patches for known rims.

/// Ratio of the spacing along a sliding runner to the even one: the front, where the ice begins to
/// yield, needs finer cells than a smooth contact.
const ALONG: f64 = 0.5;

/// Distance by which the patch is extended behind the back rim, relative to its length. It breaks
/// the symmetry about the lowest point: of two nodes at equal distances, the one behind must not be
/// deepened where ice hardly springs back.
const BEHIND: f64 = 2e-3;

/// Guesses the patch as for elastic ice, but the load of a cut is at most the hardness over the
/// half of its ellipse ahead of the lowest point.
pub(crate) fn sliding_guess(problem: &CheckedProblem) -> Patch {
    let hardness = problem.hardness();
    let most = |length: f64, width: f64| hardness * std::f64::consts::PI / 8.0 * length * width;
    regular(guess(problem, &most))
}

/// The patch with these rims [x low, x high, y low, y high]. Zones of cells end half a cell outside
/// them, so that the parts of the plane that belong to nodes end at the rims.
pub(crate) fn fitted(mut patch: Patch, [low, high, right, left]: [f64; 4]) -> Patch {
    if let Some(first) = patch.x.first_mut() {
        first.low = (low - BEHIND * (high - low)).min(first.high);
    }
    if let Some(last) = patch.x.last_mut() {
        last.high = high.max(last.low);
    }
    (patch.y.low, patch.y.high) = (right, left);
    regular(patch)
}

/// The patch with even cells, finer along than across, and still finer where the keel's curvature
/// jumps.
fn regular(mut patch: Patch) -> Patch {
    for stretch in &mut patch.x {
        stretch.sizes = vec![[0.0, ALONG], [1.0, ALONG]];
    }
    patch.y.sizes.clear();
    patch.refined_at_corners()
}
