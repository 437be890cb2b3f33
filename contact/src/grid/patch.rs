//! The expected contact patch, with the sizes of cells in it.

use crate::grid::stretch::Stretch;

/// The expected contact: intervals along x, one interval across, and the approach.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Stretches along the runner, in order.
    pub x: Vec<Stretch>,
    /// Stretch across the runner.
    pub y: Stretch,
    /// The runner's motion towards the track at which the patch is expected: approach plus the
    /// lowest gap [m].
    pub motion: f64,
    /// Places where the keel's curvature jumps.
    pub corners: Vec<Corner>,
}

/// Ratio of the spacing at a corner of the keel, for one cell over half the patch, to the contact's
/// half-width: the tip of the pressure's peak there is as wide as the contact.
const AT_CORNERS: f64 = 2.0;

/// Smallest accepted ratio of the cell size that the pressure needs to the present one; below it
/// the mesh is graded anew. Two meshes that both miss the peaks at a runner's ends would agree on a
/// wrong pressure.
pub(crate) const COARSE: f64 = 0.4;

impl Patch {
    /// Whether both have the same number of stretches and `alike` is true for each pair.
    pub fn all_stretches(&self, other: &Patch, alike: impl Fn(&Stretch, &Stretch) -> bool) -> bool {
        let mut pairs = self.x.iter().zip(&other.x);
        self.x.len() == other.x.len()
            && pairs.all(|(mine, theirs)| alike(mine, theirs))
            && alike(&self.y, &other.y)
    }

    /// This patch with the cell sizes of `other`, if both have the same stretches, so that their
    /// meshes are similar.
    pub fn with_sizes_of(mut self, other: &Patch) -> Self {
        if self.x.len() == other.x.len() {
            for (mine, theirs) in self.x.iter_mut().zip(&other.x) {
                mine.sizes.clone_from(&theirs.sizes);
            }
            self.y.sizes.clone_from(&other.y.sizes);
        }
        self
    }

    /// Whether the rims of this patch differ from those of `other` by at most the fraction `part`
    /// of half a stretch, times the relative cell size there.
    pub fn agrees_with(&self, other: &Patch, part: f64) -> bool {
        self.all_stretches(other, |mine, theirs| {
            let near = |a: f64, b: f64| (a - b).abs() <= part * mine.half() * mine.size(a);
            near(mine.low, theirs.low) && near(mine.high, theirs.high)
        })
    }

    /// Relative error of peak and approach on a mesh with this number of cells over half the patch,
    /// if the contact has the rims of `found` instead of the expected ones.
    ///
    /// Nodes carry forces up to the middle of a cell, so that the error d of a rim is its distance
    /// from the expected one. If that is most of a cell, the error is uniformly distributed up to
    /// half a cell, with the root mean square 1 / sqrt(12). The exact rim minimises the energy, so
    /// that the effect of d is quadratic: under a force F a paraboloid of radius R in contact
    /// within the radius c has the approach F / (2 E* c) + c^2 / (3 R) (I. N. Sneddon, Int. J. Eng.
    /// Sci. 3, 1965). At c = a + d this exceeds the value at a by (d / a)^2 of a^2 / R. The
    /// pressure in the middle, 2 E* c / (pi R) + (F - F_c) / (2 pi c^2) with F_c = 4 E* c^3 / (3
    /// R), is also larger by (d / a)^2. The result is the mean over both ends, and over both axes.
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

    /// This patch, refined where the keel's curvature jumps: a mesh that is not refined there does
    /// not show the narrow peaks in its pressures.
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

    /// Smallest ratio of the spacing of this patch to that of `other` at the same place, at most 1.
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

    /// Whether all cells are even: a smooth contact away from the hull's ends.
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

/// A place where the keel's curvature jumps, such as the transition from a rocker to the radius of
/// an end.
///
/// The pressure has a peak there with a logarithmic singularity of its slope, down to a distance of
/// the contact's half-width, however long the contact is. A mesh with longer cells does not see it,
/// and two such meshes agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// Position along x [m].
    pub at: f64,
    /// The length within which the curvature changes; 0 for a jump [m].
    pub within: f64,
}

/// Number of intervals in which the keel is searched first.
const INTERVALS: usize = 1000;
/// Smallest ratio of a change of the keel's curvature to the curvature across that counts: it
/// changes the pressure by a few times as much.
const MIN_CHANGE: f64 = 2e-3;
/// Largest number of corners, those with the largest changes: a rough hull may have corners
/// everywhere.
const MAX_CORNERS: usize = 12;
/// Smallest step in the search for a jump [m]: differences over shorter steps are rounding.
const SHORTEST: f64 = 1e-5;

/// The corners of heights (x, y) -> z on their line along x at `y`, in order, within the extent [x
/// low, x high, y low, y high]; empty if that is unbounded along x.
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
    // Corners next to an end of the hull cannot be recognised.
    let inside = |i: usize| changes[i - 1..=i + 1].iter().all(|size| size.is_finite());
    // Flat sections are treated as round ones of their width.
    let flattest = 2.0 / (left - right);
    let counts = |i: &usize| {
        let across = bend(|y| heights(place(*i), y), y, 0.1 * step).abs();
        inside(*i)
            && changes[*i] >= changes[*i - 1]
            && changes[*i] > changes[*i + 1]
            && changes[*i] > MIN_CHANGE * across.max(flattest).max(1.0)
    };
    let mut found: Vec<usize> = (1..INTERVALS).filter(counts).collect();
    found.sort_by(|&a, &b| changes[b].total_cmp(&changes[a]));
    found.truncate(MAX_CORNERS);
    found.sort_unstable();
    let corner = |i: usize| narrowed(&change, place(i), step);
    found.into_iter().map(corner).collect()
}

/// Curvature of a line through three points `step` apart.
fn bend(line: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
    (line(x - step) - 2.0 * line(x) + line(x + step)) / (step * step)
}

/// Locates a change of curvature near `at` with shorter and shorter steps, while it does not
/// decrease: only a jump remains to the shortest.
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
