//! What meshes say together of a figure, and how fine they are to be.

use crate::accuracy::order::{Limit, Raw, range};

/// What the meshes solved so far say of one figure.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sequence {
    meshes: Vec<Raw>,
    /// How many of the last ones are similar: the same zones, all spacings in proportion.
    similar: usize,
    /// Whether no rim between nodes moves the figure, so that it may go to and fro by law.
    alternating: bool,
}

impl Sequence {
    /// Of a figure that no rim between nodes moves.
    pub fn alternating() -> Self {
        Sequence {
            alternating: true,
            ..Self::default()
        }
    }

    /// Adds a mesh: finer and similar to the last one, or `graded_anew`.
    pub fn push(&mut self, raw: Raw, graded_anew: bool) {
        self.meshes.push(raw);
        self.similar = if graded_anew { 1 } else { self.similar + 1 };
    }

    /// How many of the last meshes are similar.
    pub fn similar(&self) -> usize {
        self.similar
    }

    /// What the last mesh says; NaN before there is one.
    pub fn value(&self) -> f64 {
        self.meshes.last().map_or(f64::NAN, |mesh| mesh.value)
    }

    /// Cells over half the patch of the last mesh.
    pub fn cells(&self) -> f64 {
        self.meshes.last().map_or(f64::NAN, |mesh| mesh.cells)
    }

    /// The limit of fine meshes: by the order of three where three are similar, else the last one's value with the spread of the last
    /// three and of what lies between them and the last coarser one. `None` before there are three, and where all have the same
    /// cells and tell nothing of finer ones.
    pub fn limit(&self) -> Option<Limit> {
        let settles =
            |meshes: &[Raw]| is_monotone(&meshes.iter().map(|m| m.value).collect::<Vec<f64>>());
        match self.three() {
            Some((three, used)) => Some(match self.alternating {
                // Three that seem to settle say nothing where those between them go to and fro.
                true if settles(&three) && !settles(&used) => Limit::of_scatter(&used),
                true => Limit::of_alternating(three),
                false => Limit::of_similar(three),
            }),
            None => self.spread(),
        }
    }

    /// As [`last`](Sequence::last), of a figure that the rim moves by as much as the cells do.
    pub fn last_by_rim(&self) -> Limit {
        match self.three() {
            Some((three, _)) => Limit::of_rim(three),
            None => self.last(),
        }
    }

    /// The same with another order beyond which values settle by accident.
    #[cfg(test)]
    pub fn last_by_rim_up_to(&self, highest: f64) -> Limit {
        match self.three() {
            Some((three, _)) => Limit::of_rim_up_to(three, highest),
            None => self.last(),
        }
    }

    /// Of the similar meshes those that tell the order, and all from the first of them on.
    fn three(&self) -> Option<([Raw; 3], Vec<Raw>)> {
        let &[.., third] = &self.meshes[..] else {
            return None;
        };
        if let [coarser @ .., before, _, _] = &self.meshes[self.meshes.len() - self.similar..] {
            // Far apart scatter counts least; not so far that the coarsest is in another range.
            let near = |mesh: &&Raw| mesh.cells >= third.cells / WIDEST;
            let first = coarser.iter().find(near).unwrap_or(before);
            let middle = (first.cells * third.cells).sqrt();
            let off = |mesh: &Raw| (mesh.cells / middle).ln().abs();
            let similar = &self.meshes[self.meshes.len() - self.similar..];
            let between = similar
                .iter()
                .filter(|mesh| mesh.cells > first.cells && mesh.cells < third.cells);
            let second = between.min_by(|a, b| off(a).total_cmp(&off(b)))?;
            let used = similar.iter().filter(|mesh| mesh.cells >= first.cells);
            return Some(([*first, *second, third], used.copied().collect()));
        }
        None
    }

    /// The last mesh's value with the spread of the last three and of what lies between them and the last coarser one.
    fn spread(&self) -> Option<Limit> {
        let third = self.meshes.last()?;
        let third_last = self.meshes.len().checked_sub(3)?;
        let coarser = self.meshes.iter().rposition(|m| m.cells < third.cells)?;
        Some(self.spread_from(coarser.min(third_last)))
    }

    /// The same where nothing tells the limit: the last mesh's value with the spread of up to three.
    pub fn last(&self) -> Limit {
        self.limit()
            .unwrap_or_else(|| self.spread_from(self.meshes.len().saturating_sub(3)))
    }

    /// The range of what the last three meshes say; infinite for a single one.
    pub fn range(&self) -> f64 {
        range(&self.values_from(self.meshes.len().saturating_sub(3)))
    }

    fn spread_from(&self, start: usize) -> Limit {
        Limit::of_spread(&self.values_from(start))
    }

    fn values_from(&self, start: usize) -> Vec<f64> {
        self.meshes[start..].iter().map(|mesh| mesh.value).collect()
    }
}

/// Whether values only rise or only fall.
fn is_monotone(values: &[f64]) -> bool {
    values.is_sorted() || values.iter().rev().is_sorted()
}

/// Most times finer that the last of three meshes is than the first.
const WIDEST: f64 = 3.0;

/// How much finer the second and third mesh of a sequence are than the one before: the third has twice the cells of the first.
pub(crate) const REFINEMENT: f64 = std::f64::consts::SQRT_2;

/// Cells of the first of three meshes that should meet the tolerance on a smooth contact; where the pressure peaks at the hull's
/// ends, meshes of fewer than [`ENDS`] cells are not yet in the range in which their errors shrink steadily. [`MOST`] serves 0.01 %.
pub(crate) fn first_resolution(tolerance: f64, smooth: bool) -> f64 {
    const ENDS: f64 = 4.0;
    const MOST: f64 = 20.0;
    let least = if smooth { 3.0 } else { ENDS };
    (0.175 / tolerance.sqrt() + 1.25).clamp(least, MOST)
}

/// Least ratio of cells of a mesh and the one before that tells anything.
pub(crate) const LEAST_REFINEMENT: f64 = 1.25;

/// How much finer than a mesh of so many times the tolerance's error the next one is to be: errors of second order, some room, and
/// neither so near that it tells nothing nor so far that it costs all.
pub(crate) fn next_refinement(excess: f64) -> f64 {
    (1.05 * excess.sqrt()).clamp(LEAST_REFINEMENT, 1.6)
}
