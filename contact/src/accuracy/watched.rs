//! The figures that accuracy watches, mesh by mesh.

use crate::accuracy::extrapolation::{Extrapolation, Raw, Sequence};
use crate::result::measure::Figures;

/// What the meshes solved so far say of peak pressure, area and length.
pub(crate) struct Watched {
    peak: Sequence,
    /// Of all meshes, in order.
    figures: Vec<Figures>,
    /// Largest pressure that the ice bears [Pa].
    hardness: f64,
}

/// Area and length, whose errors are of first order, are asked to be twice as uncertain as a peak.
pub(crate) const BESIDE: f64 = 0.5;

/// Limits of fine meshes, and what is not known of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Peak pressure and approach.
    pub peak: Extrapolation,
    /// Error of the last mesh's area [m2].
    pub area_error: f64,
    /// Error of the last mesh's length [m].
    pub length_error: f64,
    /// Relative error of what is watched: the peak's, or where the ice's hardness fixes that, [`BESIDE`] times the larger one of
    /// area and length.
    pub relative: f64,
}

impl Watched {
    pub fn new(hardness: Option<f64>) -> Self {
        Watched {
            peak: Sequence::new(),
            figures: Vec::new(),
            hardness: hardness.unwrap_or(f64::INFINITY),
        }
    }

    /// Adds a mesh: similar to the last one and finer, or `graded_anew`.
    pub fn push(&mut self, figures: Figures, cells: f64, approach: f64, graded_anew: bool) {
        let raw = Raw {
            cells,
            value: figures.p_max,
            approach,
        };
        self.peak.push(raw, graded_anew);
        self.figures.push(figures);
    }

    /// The limits; `None` before there is anything to compare. On `smooth` contacts the order of the peak's errors is known.
    pub fn limits(&self, smooth: bool) -> Option<Limits> {
        self.of(self.peak.limit(smooth)?)
    }

    /// The last mesh with what is known of its errors.
    pub fn last(&self) -> Option<Limits> {
        self.of(self.peak.last()?)
    }

    /// Twice the larger of the last two meshes' changes: what is left where errors fall with the cells' size and those are 1.5 times
    /// smaller on each mesh. The rim passes between nodes, so that no higher order is certain. Infinite after one mesh.
    fn uncertain(&self, figure: impl Fn(&Figures) -> f64) -> f64 {
        let pairs = self.figures.windows(2).rev().take(2);
        let changes = pairs.map(|pair| (figure(&pair[1]) - figure(&pair[0])).abs());
        match changes.reduce(f64::max) {
            Some(change) => 2.0 * change,
            None => f64::INFINITY,
        }
    }

    fn of(&self, peak: Extrapolation) -> Option<Limits> {
        let last = *self.figures.last()?;
        let area_error = self.uncertain(|figures| figures.area);
        let length_error = self.uncertain(|figures| figures.length);
        let fixed = last.p_max >= self.hardness * (1.0 - 1e-9);
        let (peak, relative) = if fixed {
            let peak = Extrapolation {
                value: self.hardness,
                error: 0.0,
                ..peak
            };
            let relative = BESIDE * (area_error / last.area).max(length_error / last.length);
            (peak, relative)
        } else {
            let value = peak.value.min(self.hardness);
            (Extrapolation { value, ..peak }, peak.error / value)
        };
        Some(Limits {
            peak,
            area_error,
            length_error,
            relative,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mesh of so many cells whose figures have errors of second order, in parts of their limits 30e6 Pa, 1 m2 and 0.1 m.
    fn pushed(watched: &mut Watched, cells: f64, parts: [f64; 3]) {
        let of = |limit: f64, part: f64| limit * (1.0 + part / (cells * cells));
        let figures = Figures {
            p_max: of(30e6, parts[0]).min(watched.hardness),
            area: of(1.0, parts[1]),
            length: of(0.1, parts[2]),
            width: 0.01,
        };
        watched.push(figures, cells, 1e-6, false);
    }

    #[test]
    fn where_hardness_fixes_the_peak_area_and_length_are_watched() {
        let mut watched = Watched::new(Some(20e6));
        pushed(&mut watched, 4.0, [0.5, 0.5, -1.0]);
        assert!(watched.limits(true).is_none());
        assert_eq!(watched.last().map(|l| l.relative), Some(f64::INFINITY));
        pushed(&mut watched, 6.0, [0.5, 0.5, -1.0]);
        let limits = watched.limits(true).expect("two meshes");
        assert_eq!((limits.peak.value, limits.peak.error), (20e6, 0.0));
        // The length is off by 1/36: that is seen, and not stated many times too large.
        let relative = limits.length_error / 0.1;
        assert!(relative > 1.0 / 36.0 && relative < 0.15, "{limits:?}");
        assert!(limits.relative >= BESIDE * relative, "{limits:?}");
        assert!(limits.length_error > 0.1 / 36.0);
    }

    #[test]
    fn a_peak_below_the_hardness_is_watched_itself_and_never_extrapolated_beyond() {
        let mut watched = Watched::new(Some(30.001e6));
        pushed(&mut watched, 4.0, [-0.5, 0.5, -1.0]);
        pushed(&mut watched, 6.0, [-0.4, 0.5, -1.0]);
        let limits = watched.limits(true).expect("two meshes");
        assert!(limits.peak.value <= 30.001e6 && limits.peak.error > 0.0);
        assert!((limits.relative - limits.peak.error / limits.peak.value).abs() < 1e-12);
    }
}
