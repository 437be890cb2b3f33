//! The limit of fine meshes, from what two or three of them say.

/// What one mesh says.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Raw {
    pub cells: f64,
    pub p_max: f64,
    pub approach: f64,
}

/// Peak pressure and approach in the limit of fine meshes, from two similar meshes.
///
/// Similar meshes (the same zones, all spacings in proportion) have errors c h^2 + higher terms, so that
/// p = p2 + (p2 - p1) / (r^2 - 1) with r the ratio of their resolutions (L. F. Richardson, 1911).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extrapolation {
    pub p_max: f64,
    pub error: f64,
    pub approach: f64,
}

impl Extrapolation {
    /// Share of the extrapolation's step that is reported as error: on the closed forms that the tests compare
    /// with it holds the true error.
    const SHARE: f64 = 0.4;
    /// Scatter of the peak pressure with the place of the rim between nodes, times the square of the cells.
    const SCATTER: f64 = 0.03;

    /// The limit of two meshes. Where the patch is not smooth (it wanted uneven cells) nothing is known of the order,
    /// and the whole difference of the two is the error.
    pub fn new(coarse: Raw, fine: Raw, smooth: bool) -> Self {
        let scatter = Self::SCATTER / (fine.cells * fine.cells) * fine.p_max;
        if !smooth {
            let error = (fine.p_max - coarse.p_max).abs() + scatter;
            return Extrapolation {
                p_max: fine.p_max,
                error,
                approach: fine.approach,
            };
        }
        let divisor = (fine.cells / coarse.cells).powi(2) - 1.0;
        let step = (fine.p_max - coarse.p_max) / divisor;
        Extrapolation {
            p_max: fine.p_max + step,
            error: Self::SHARE * step.abs() + scatter,
            approach: fine.approach + (fine.approach - coarse.approach) / divisor,
        }
    }

    /// The limit of three meshes whose steps shrink steadily, as a geometric series (A. C. Aitken, 1926); half of what
    /// is added is the error. `None` where the steps do not shrink by at least 0.6 in one direction.
    pub fn geometric(first: Raw, second: Raw, third: Raw) -> Option<Self> {
        let steps = [second.p_max - first.p_max, third.p_max - second.p_max];
        let ratio = steps[1] / steps[0];
        if !(0.0..0.6).contains(&ratio) {
            return None;
        }
        let rest = steps[1] * ratio / (1.0 - ratio);
        let scatter = Self::SCATTER / (third.cells * third.cells) * third.p_max;
        Some(Extrapolation {
            p_max: third.p_max + rest,
            error: 0.5 * rest.abs() + 0.1 * steps[1].abs() + scatter,
            approach: third.approach,
        })
    }
}

/// Cells of the first of two meshes whose extrapolation should meet the tolerance on a smooth contact.
///
/// Where the pressure peaks at the hull's ends, fewer than [`ENDS`] cells miss the peak by several per cent in either
/// direction, and two such meshes may agree by accident.
pub(crate) fn first_resolution(tolerance: f64, smooth: bool) -> f64 {
    const ENDS: f64 = 7.0;
    let least = if smooth { 4.0 } else { ENDS };
    (0.21 / tolerance.sqrt()).ceil().clamp(least, 16.0)
}
