//! Where contact is expected, and how fine cells are to be there.

use crate::grid::corners::Corner;
use crate::grid::stretch::Stretch;

/// Where contact is expected: intervals along x, one interval across, and the approach.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Stretches along the runner, in order.
    pub x: Vec<Stretch>,
    /// Stretch across the runner.
    pub y: Stretch,
    /// The runner's motion towards the track at which the patch is expected: approach plus the lowest gap [m].
    pub motion: f64,
    /// Where the keel's curvature jumps.
    pub corners: Vec<Corner>,
}

/// Wanted spacing at a corner of the keel, at one cell over half the patch, over the contact's half-width: the tip of a
/// pressure's peak there is as wide as the contact.
const AT_CORNERS: f64 = 2.0;

/// A mesh whose own pressure asks somewhere for cells below this part of those there is graded anew: two meshes that both miss the
/// peaks at a runner's ends would agree on a wrong pressure.
pub(crate) const COARSE: f64 = 0.6;

impl Patch {
    /// This patch, resolved like `other` where both have the same stretches: their meshes are similar.
    pub fn with_sizes_of(mut self, other: &Patch) -> Self {
        if self.x.len() == other.x.len() {
            for (mine, theirs) in self.x.iter_mut().zip(&other.x) {
                mine.sizes.clone_from(&theirs.sizes);
            }
            self.y.sizes.clone_from(&other.y.sizes);
        }
        self
    }

    /// Whether this patch's rims are those of `other` to a `part` of their stretches' halves, as fine as cells are there.
    pub fn agrees_with(&self, other: &Patch, part: f64) -> bool {
        let agree = |mine: &Stretch, theirs: &Stretch| {
            let near = |a: f64, b: f64| (a - b).abs() <= part * mine.half() * mine.size(a);
            near(mine.low, theirs.low) && near(mine.high, theirs.high)
        };
        let pairs = self.x.iter().zip(&other.x);
        self.x.len() == other.x.len()
            && pairs
                .chain([(&self.y, &other.y)])
                .all(|(mine, theirs)| agree(mine, theirs))
    }

    /// What peak and approach of a mesh with so many cells over half the patch are off by, relative, since the contact has the rims of `found`
    /// and the mesh was made for these.
    ///
    /// Nodes carry forces up to the middle of a cell, so that a rim is missed by d: its distance from the one expected; where that is most of
    /// a cell the lines of nodes miss it by anything up to half of one, in the mean of squares by 1 / sqrt(12). The right rim makes the energy least, so that d counts squared: under a force F a paraboloid of radius R that touches within c
    /// has the approach F / (2 E* c) + c^2 / (3 R) (I. N. Sneddon, Int. J. Eng. Sci. 3, 1965), at c = a + d (d / a)^2 of a^2 / R more than
    /// at a; and in its middle the pressure 2 E* c / (pi R) + (F - F_c) / (2 pi c^2), F_c = 4 E* c^3 / (3 R), (d / a)^2 more too. Here the means
    /// over both ends, and along and across.
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
        let along = self.x.iter().zip(&found.x);
        let along = along.map(|(mine, theirs)| missed(mine, theirs));
        0.5 * (along.fold(0.0, f64::max) + missed(&self.y, &found.y))
    }

    /// This patch, refined where the keel's curvature jumps: the peaks there are too narrow for a mesh that does not
    /// know of them, whatever it says of the pressure.
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

    /// Smallest spacing that this patch asks for over the one that `other` has there; 1 where it asks for none.
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

    /// Smallest wanted spacing over the even one.
    pub fn finest(&self) -> f64 {
        let stretches = self.x.iter().chain([&self.y]);
        stretches.map(Stretch::finest).fold(1.0, f64::min)
    }

    /// Whether even cells do everywhere: a smooth contact away from its hull's ends.
    pub fn is_even(&self) -> bool {
        self.finest() == 1.0
    }

    /// From its first to its last point along x [m].
    pub fn span_x(&self) -> [f64; 2] {
        match (self.x.first(), self.x.last()) {
            (Some(first), Some(last)) => [first.low, last.high],
            _ => [0.0; 2],
        }
    }
}
