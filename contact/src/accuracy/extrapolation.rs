//! The limit of fine meshes, from what two or three of them say.

/// What one mesh says of a figure: peak pressure [Pa], area [m2] or length [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Raw {
    pub cells: f64,
    pub value: f64,
    pub approach: f64,
}

/// A figure and the approach in the limit of fine meshes, from two similar meshes.
///
/// Similar meshes (the same zones, all spacings in proportion) have errors c h^2 + higher terms, so that
/// p = p2 + (p2 - p1) / (r^2 - 1) with r the ratio of their resolutions (L. F. Richardson, 1911).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extrapolation {
    pub value: f64,
    pub error: f64,
    pub approach: f64,
}

impl Extrapolation {
    /// Share of the extrapolation's step that is reported as error: on the closed forms that the tests compare
    /// with it holds the true error.
    const SHARE: f64 = 0.4;
    /// Scatter of the peak pressure with the place of the rim between nodes, times the square of the cells.
    const SCATTER: f64 = 0.03;

    fn scatter(raw: Raw) -> f64 {
        Self::SCATTER / (raw.cells * raw.cells) * raw.value
    }

    /// The limit of two meshes. Where the patch is not smooth (it wanted uneven cells) the order is not certain, and the
    /// whole difference of the two is the error.
    fn of_two(coarse: Raw, fine: Raw, smooth: bool) -> Self {
        let divisor = (fine.cells / coarse.cells).powi(2) - 1.0;
        let difference = fine.value - coarse.value;
        let share = if smooth { Self::SHARE / divisor } else { 1.0 };
        Extrapolation {
            value: fine.value + difference / divisor,
            error: share * difference.abs() + Self::scatter(fine),
            approach: fine.approach + (fine.approach - coarse.approach) / divisor,
        }
    }

    /// The limit of three meshes whose steps shrink steadily, as a geometric series (A. C. Aitken, 1926); what is added
    /// is the error. Steps that shrink by more than these meshes' order allows do so by accident: then the
    /// error is at least what that order leaves of the first step. `None` where they do not shrink by at least 0.6.
    fn of_three([first, second, third]: [Raw; 3]) -> Option<Self> {
        let steps = [second.value - first.value, third.value - second.value];
        let ratio = steps[1] / steps[0];
        let fastest = (second.cells / third.cells).powi(2);
        if ratio.abs() < 0.5 * fastest {
            let limit = Self::of_two(second, third, false);
            let error = limit.error.max(fastest * steps[0].abs());
            return Some(Extrapolation { error, ..limit });
        }
        if !(0.0..0.6).contains(&ratio) {
            return None;
        }
        let rest = steps[1] * ratio / (1.0 - ratio);
        Some(Extrapolation {
            value: third.value + rest,
            error: rest.abs() + 0.1 * steps[1].abs() + Self::scatter(third),
            approach: third.approach,
        })
    }
}

/// What the meshes solved so far say together.
#[derive(Debug)]
pub(crate) struct Sequence {
    /// The latest similar ones, from coarse to fine.
    similar: Vec<Raw>,
    /// What a mesh graded anew changed, and what the refinements before it left.
    regraded: f64,
    /// What the mesh before the last one said, similar to it or not.
    before: Option<f64>,
}

impl Sequence {
    pub fn new() -> Self {
        Sequence {
            similar: Vec::new(),
            regraded: f64::INFINITY,
            before: None,
        }
    }

    /// Adds a finer mesh that is similar to the last one, or one of as many cells that is `graded_anew`.
    pub fn push(&mut self, raw: Raw, graded_anew: bool) {
        self.before = self.similar.last().map(|last| last.value).or(self.before);
        if graded_anew {
            let left = match self.similar[..] {
                [.., coarse, fine] => (fine.value - coarse.value).abs(),
                _ => self.regraded,
            };
            let change = self
                .similar
                .last()
                .map_or(0.0, |last| raw.value - last.value);
            self.regraded = left + change.abs();
            self.similar.clear();
        }
        self.similar.push(raw);
    }

    /// The figure and the approach in the limit; `None` before there is anything to compare.
    pub fn limit(&self, smooth: bool) -> Option<Extrapolation> {
        match self.similar[..] {
            [.., coarse, fine] if smooth => Some(Extrapolation::of_two(coarse, fine, true)),
            [.., first, second, third] => Extrapolation::of_three([first, second, third])
                .or_else(|| Some(Extrapolation::of_two(second, third, false))),
            [coarse, fine] => Some(Extrapolation::of_two(coarse, fine, false)),
            [only] if self.regraded.is_finite() => Some(Extrapolation {
                value: only.value,
                error: self.regraded + Extrapolation::scatter(only),
                approach: only.approach,
            }),
            _ => None,
        }
    }
}

impl Sequence {
    /// The last mesh's figure with what is known of its error where nothing tells the limit: twice its difference from the mesh
    /// before, infinite where there is none.
    pub fn last(&self) -> Option<Extrapolation> {
        let last = *self.similar.last()?;
        let change = self
            .before
            .map_or(f64::INFINITY, |b| (last.value - b).abs());
        Some(Extrapolation {
            value: last.value,
            error: 2.0 * change + Extrapolation::scatter(last),
            approach: last.approach,
        })
    }
}

/// Cells of the first of two meshes whose extrapolation should meet the tolerance on a smooth contact.
///
/// Where the pressure peaks at the hull's ends, meshes of fewer than [`ENDS`] cells are not yet in the range in which their
/// errors shrink steadily.
pub(crate) fn first_resolution(tolerance: f64, smooth: bool) -> f64 {
    const ENDS: f64 = 5.0;
    let least = if smooth { 4.0 } else { ENDS };
    (0.21 / tolerance.sqrt()).ceil().clamp(least, 16.0)
}
