//! Where contact is expected, and how fine cells are to be there.

use crate::grid::stretch::Stretch;

/// Where contact is expected: intervals along x, one interval across, and the approach.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Stretches along the runner, in order.
    pub x: Vec<Stretch>,
    /// Stretch across the runner.
    pub y: Stretch,
    /// The runner's motion towards the track at which the patch is expected: approach plus the
    /// lowest gap [m].
    pub motion: f64,
    /// Where the keel's curvature jumps.
    pub corners: Vec<Corner>,
}

/// Wanted spacing at a corner of the keel, at one cell over half the patch, over the contact's
/// half-width: the tip of a pressure's peak there is as wide as the contact.
const AT_CORNERS: f64 = 2.0;

/// A mesh whose own pressure needs cells somewhere below this part of those there is graded anew:
/// two meshes that both miss the peaks at a runner's ends would agree on a wrong pressure.
pub(crate) const COARSE: f64 = 0.4;

impl Patch {
    /// Whether both have as many stretches, and `alike` holds of each with that of `other`.
    pub fn all_stretches(&self, other: &Patch, alike: impl Fn(&Stretch, &Stretch) -> bool) -> bool {
        let mut pairs = self.x.iter().zip(&other.x);
        self.x.len() == other.x.len()
            && pairs.all(|(mine, theirs)| alike(mine, theirs))
            && alike(&self.y, &other.y)
    }

    /// This patch, resolved like `other` where both have the same stretches: their meshes are
    /// similar.
    pub fn with_sizes_of(mut self, other: &Patch) -> Self {
        if self.x.len() == other.x.len() {
            for (mine, theirs) in self.x.iter_mut().zip(&other.x) {
                mine.sizes.clone_from(&theirs.sizes);
            }
            self.y.sizes.clone_from(&other.y.sizes);
        }
        self
    }

    /// Whether this patch's rims are those of `other` to a `part` of their stretches' halves, as
    /// fine as cells are there.
    pub fn agrees_with(&self, other: &Patch, part: f64) -> bool {
        self.all_stretches(other, |mine, theirs| {
            let near = |a: f64, b: f64| (a - b).abs() <= part * mine.half() * mine.size(a);
            near(mine.low, theirs.low) && near(mine.high, theirs.high)
        })
    }

    /// What peak and approach of a mesh with so many cells over half the patch are off by,
    /// relative, since the contact has the rims of `found` and the mesh was made for these.
    ///
    /// Nodes carry forces up to the middle of a cell, so that a rim is missed by d: its distance
    /// from the one expected; where that is most of a cell the lines of nodes miss it by anything
    /// up to half of one, in the mean of squares by 1 / sqrt(12). The right rim makes the energy
    /// least, so that d counts squared: under a force F a paraboloid of radius R that touches
    /// within c has the approach F / (2 E* c) + c^2 / (3 R) (I. N. Sneddon, Int. J. Eng. Sci. 3,
    /// 1965), at c = a + d (d / a)^2 of a^2 / R more than at a; and in its middle the pressure 2 E*
    /// c / (pi R) + (F - F_c) / (2 pi c^2), F_c = 4 E* c^3 / (3 R), (d / a)^2 more too. Here the
    /// means over both ends, and along and across.
    pub fn missed(&self, found: &Patch, cells: f64) -> f64 {
        let missed = |mine: &Stretch, theirs: &Stretch| {
            let at = |here: f64, there: f64| {
                let cell = mine.size(here) / cells;
                ((there - here).abs() / mine.half())
                    .min(cell / 12f64.sqrt())
                    .powi(2)
            };
            0.5 * (at(mine.low, theirs.low) + at(mine.high, theirs.high))
        };
        let pairs = self.x.iter().zip(&found.x);
        let along = pairs.map(|(mine, theirs)| missed(mine, theirs));
        0.5 * (along.fold(0.0, f64::max) + missed(&self.y, &found.y))
    }

    /// This patch, refined where the keel's curvature jumps: the peaks there are too narrow for a
    /// mesh without cells for them, whatever its pressures.
    pub fn refined_at_corners(mut self) -> Self {
        let width = self.y.half();
        for stretch in &mut self.x {
            let half = stretch.half();
            for corner in &self.corners {
                stretch.refine_at(corner.at, (AT_CORNERS * width).max(corner.within) / half);
            }
        }
        self
    }

    /// Smallest spacing that this patch needs over the one that `other` has there; 1 where it
    /// needs none.
    pub fn finest_over(&self, other: &Patch) -> f64 {
        let over = |mine: &Stretch, theirs: &Stretch| {
            mine.spacings()
                .map(|[x, spacing]| spacing / (theirs.half() * theirs.size(x)))
                .fold(1.0, f64::min)
        };
        let along = self.x.iter().map(|mine| {
            let under = other.x.iter().find(|theirs| theirs.meets(mine));
            under.map_or(1.0, |theirs| over(mine, theirs))
        });
        along.fold(over(&self.y, &other.y), f64::min)
    }

    /// Whether even cells do everywhere: a smooth contact away from its hull's ends.
    pub fn is_even(&self) -> bool {
        let mut stretches = self.x.iter().chain([&self.y]);
        stretches.all(|stretch| stretch.finest() == 1.0)
    }

    /// From its first to its last point along x [m].
    pub fn span_x(&self) -> [f64; 2] {
        match (self.x.first(), self.x.last()) {
            (Some(first), Some(last)) => [first.low, last.high],
            _ => [0.0; 2],
        }
    }
}

// Places along a runner where its keel's curvature jumps.

/// A place where the keel's curvature changes at once, as where a rocker goes over into an end's
/// radius.
///
/// A pressure has a peak there with a tip of logarithms: its slope grows like ln(distance) down to
/// a distance of the contact's half-width, however long the contact is. A mesh with cells longer
/// than that does not see it, and two such meshes agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// Where [m].
    pub at: f64,
    /// The length within which the curvature changes; 0 for a jump [m].
    pub within: f64,
}

/// Intervals in which the keel is searched first.
const INTERVALS: usize = 1000;
/// Smallest change of the curvature that counts, over the curvature across: it moves a pressure by
/// a few times as much.
const LEAST: f64 = 2e-3;
/// Most corners that are used, the largest changes first: a rough hull may have one everywhere.
const MOST: usize = 12;
/// A jump is searched down to this step [m]: differences over shorter ones are rounding.
const SHORTEST: f64 = 1e-5;

/// The corners of heights (x, y) -> z on their line along x at `y`, in order, within the extent [x
/// low, x high, y low, y high]; none where that is unbounded along x.
pub(crate) fn corners(heights: impl Fn(f64, f64) -> f64, extent: [f64; 4], y: f64) -> Vec<Corner> {
    let [low, high, right, left] = extent;
    let step = (high - low) / INTERVALS as f64;
    if !step.is_finite() {
        return Vec::new();
    }
    let keel = |x: f64| heights(x, y);
    let change =
        |x: f64, step: f64| (bend(keel, x + step, step) - bend(keel, x - step, step)).abs();
    let place = |i: usize| low + step * i as f64;
    let changes: Vec<f64> = (0..=INTERVALS).map(|i| change(place(i), step)).collect();
    // Next to a place that the hull does not reach no corner can be recognised.
    let inside = |i: usize| changes[i - 1..=i + 1].iter().all(|size| size.is_finite());
    // Flat sections count as round ones of their width.
    let flattest = 2.0 / (left - right);
    let counts = |i: &usize| {
        let across = bend(|y| heights(place(*i), y), y, 0.1 * step).abs();
        inside(*i)
            && changes[*i] >= changes[*i - 1]
            && changes[*i] > changes[*i + 1]
            && changes[*i] > LEAST * across.max(flattest).max(1.0)
    };
    let mut found: Vec<usize> = (1..INTERVALS).filter(counts).collect();
    found.sort_by(|&a, &b| changes[b].total_cmp(&changes[a]));
    found.truncate(MOST);
    found.sort_unstable();
    let corner = |i: usize| narrowed(&change, place(i), step);
    found.into_iter().map(corner).collect()
}

/// Curvature of a line through three points `step` apart.
fn bend(line: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
    (line(x - step) - 2.0 * line(x) + line(x + step)) / (step * step)
}

/// Follows a change of curvature near `at` to shorter steps for as long as it stays as large: only
/// a jump does.
fn narrowed(change: &impl Fn(f64, f64) -> f64, mut at: f64, mut step: f64) -> Corner {
    let change = |x: f64, step: f64| {
        let size = change(x, step);
        if size.is_finite() { size } else { 0.0 }
    };
    let size = change(at, step);
    while step > SHORTEST {
        let shorter = 0.5 * step;
        let places = (-8..=8).map(|i| at + 0.25 * step * f64::from(i));
        let place = places
            .max_by(|&a, &b| change(a, shorter).total_cmp(&change(b, shorter)))
            .unwrap_or(at);
        if change(place, shorter) < 0.7 * size {
            return Corner { at, within: step };
        }
        (at, step) = (place, shorter);
    }
    Corner { at, within: 0.0 }
}

#[cfg(test)]
mod tests {
    use kufe_mesh::{BobRunner, Paraboloid, Underside};

    use super::*;

    fn of(hull: &dyn Underside) -> Vec<Corner> {
        corners(|x, y| hull.height(x, y), hull.extent(), 0.0)
    }

    #[test]
    fn a_runner_has_its_corners_where_its_rocker_ends_and_a_paraboloid_has_none() {
        let runner = BobRunner::default().swept().unwrap();
        let start = 0.5 * runner.length() - runner.ends().unwrap().length;
        let found = of(&runner);
        assert_eq!(found.len(), 2, "{found:?}");
        for (corner, at) in found.iter().zip([-start, start]) {
            assert!((corner.at - at).abs() < SHORTEST, "{corner:?} {at}");
            assert_eq!(corner.within, 0.0);
        }
        assert_eq!(of(&Paraboloid::new(30.0, 0.005).unwrap()), Vec::new());
    }

    /// A keel whose curvature rises by 5 1/m within 4 mm about 0.2 m.
    struct Bent;

    impl Underside for Bent {
        fn height(&self, x: f64, y: f64) -> f64 {
            x * x / 60.0 + y * y / 0.01 + 2.5 * smooth_square(x - 0.2, 0.002)
        }
        fn extent(&self) -> [f64; 4] {
            [-0.5, 0.5, -0.005, 0.005]
        }
        fn mirror_symmetric(&self) -> [bool; 2] {
            [false, true]
        }
    }

    /// x^2 for x > 0, 0 for x < 0, with the bend spread over `width`.
    fn smooth_square(x: f64, width: f64) -> f64 {
        let ramp = 0.5 * (x + x.hypot(width));
        ramp * ramp
    }

    #[test]
    fn a_gradual_change_is_a_corner_as_wide_as_it_is() {
        let found = of(&Bent);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].at - 0.2).abs() < 0.002, "{found:?}");
        assert!((0.4e-3..4e-3).contains(&found[0].within), "{found:?}");
    }
}
