//! The figures of a contact on a sequence of meshes, with their limits and errors.

use crate::Measure;
use crate::accuracy::estimators::{MAX_ORDER, MeshValue, Sequence, Settling};
use crate::options::AREA_WEIGHT;
use crate::result::measure::Figures;
use crate::{LargestShear, UnderPeak};

/// The history of every figure over the meshes solved so far.
pub(crate) struct FigureHistory {
    peak: Sequence,
    approach: Sequence,
    area: Sequence,
    /// Difference of each mesh's area between two estimators of the rim.
    area_off: Vec<MeshValue>,
    length: Sequence,
    width: Sequence,
    tilt: [Sequence; 2],
    under: ShearHistory,
    /// Figures of the last mesh.
    last: Option<Figures>,
    /// Relative error of peak and approach that comes from rims the mesh was not made for.
    pub missed: f64,
    /// Hardness of the ice [Pa].
    hardness: f64,
    floor: ErrorFloor,
}

/// Relative errors that refinement does not reduce. They are independent of the errors estimated
/// from meshes and added in quadrature.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorFloor {
    /// Error of the peak and of the area, which depend on the compliance by the same power; that of
    /// lengths is half of it.
    pub peak: f64,
    /// Error of the approach.
    pub approach: f64,
}

/// Limits for fine meshes with their errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Peak pressure [Pa].
    pub peak: Measure,
    /// Approach [m].
    pub approach: Measure,
    /// Error of the last mesh's area [m2].
    pub area_error: f64,
    /// Error of the last mesh's length [m].
    pub length_error: f64,
    /// Error of the last mesh's width [m].
    pub width_error: f64,
    /// Errors of the last mesh's pitch and roll [rad].
    pub tilt_errors: [f64; 2],
    /// Relative error that is compared with the tolerance: that of the peak or, where the ice's
    /// hardness fixes the peak, [`AREA_WEIGHT`] times that of the area.
    pub relative: f64,
}

/// Position of the runner on a mesh, and the fit of the mesh to the contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Approach from first touch [m].
    pub approach: f64,
    /// Pitch and roll [rad].
    pub tilt: [f64; 2],
    /// Relative error of peak and approach that comes from rims the mesh was not made for.
    pub missed: f64,
    /// Whether the mesh is graded to a ridge of the pressure, or to an end of the hull.
    pub at_ridge: bool,
}

/// Uncertainty of a rim without yielding ice next to it, in cells: rims of 141 elliptic contacts
/// have errors of up to 0.11 cells, of one sign on all meshes.
const RIM_SHARE: f64 = 0.125;

impl FigureHistory {
    pub fn new(hardness: Option<f64>, floor: ErrorFloor) -> Self {
        FigureHistory {
            peak: Sequence::new(Settling::Alternating),
            approach: Sequence::default(),
            area: Sequence::default(),
            area_off: Vec::new(),
            length: Sequence::default(),
            width: Sequence::default(),
            tilt: [Sequence::default(), Sequence::default()],
            under: ShearHistory::new(),
            last: None,
            missed: 0.0,
            hardness: hardness.unwrap_or(f64::INFINITY),
            floor,
        }
    }

    /// The history of a contact of many asperities.
    pub fn of_asperities(hardness: Option<f64>) -> Self {
        FigureHistory {
            peak: Sequence::new(Settling::Scatter),
            ..FigureHistory::new(hardness, ErrorFloor::default())
        }
    }

    /// Adds a mesh: similar to the last one and finer, or `graded_anew`.
    ///
    /// `cells` are its cells over half of the patch (or of one of many asperities), over half the
    /// length and over half the width of the contact.
    pub fn push(
        &mut self,
        figures: Figures,
        place: Place,
        [cells, along, across]: [f64; 3],
        graded_anew: bool,
    ) {
        if place.at_ridge {
            self.peak.set_at_ridge();
        }
        let [pitch, roll] = &mut self.tilt;
        for (sequence, cells, value) in [
            (&mut self.peak, cells, figures.p_max),
            (&mut self.approach, cells, place.approach),
            (&mut self.area, cells, figures.area),
            (&mut self.length, along, figures.length),
            (&mut self.width, across, figures.width),
            (pitch, cells, place.tilt[0]),
            (roll, cells, place.tilt[1]),
        ] {
            sequence.push(MeshValue { cells, value }, graded_anew);
        }
        let value = figures.uncertainty[0];
        self.area_off.push(MeshValue { cells, value });
        self.last = Some(figures);
        self.missed = place.missed;
    }

    /// Adds the largest shear under the peak of the mesh that was pushed last.
    pub fn push_under(&mut self, largest: Option<LargestShear>, cells: f64, graded_anew: bool) {
        self.under.push(largest, cells, graded_anew);
    }

    /// The largest shear under the peak. It has the peak's error floor.
    pub fn under_peak(&self) -> Option<UnderPeak> {
        self.under.under_peak(self.floor.peak, self.missed)
    }

    /// Number of last meshes that are similar.
    pub fn similar(&self) -> usize {
        self.peak.similar()
    }

    /// The limits; `None` while there are too few meshes, and on meshes without contact.
    pub fn limits(&self) -> Option<Limits> {
        let limits = self.peak.limit().and_then(|peak| self.of(peak));
        limits.filter(|limits| !limits.relative.is_nan())
    }

    /// The last mesh with its error estimates.
    ///
    /// # Panics
    /// Before there is a mesh.
    pub fn last(&self) -> Limits {
        self.of(self.peak.last()).expect("a mesh")
    }

    /// The last mesh, its peak, area and length without an error estimate.
    ///
    /// # Panics
    /// Before there is a mesh.
    pub fn unjudged(&self) -> Limits {
        let judged = self.last();
        Limits {
            peak: Measure {
                value: self.peak.value(),
                error: f64::INFINITY,
            },
            approach: Measure {
                value: self.approach.value(),
                ..judged.approach
            },
            area_error: f64::INFINITY,
            length_error: f64::INFINITY,
            relative: f64::INFINITY,
            ..judged
        }
    }

    /// The approach with its error where ice yields, by this largest order.
    #[cfg(test)]
    pub fn approach_by_rim_up_to(&self, highest: f64) -> Measure {
        let Measure { value, error } = self.approach.last_at_rim(highest);
        Measure {
            value,
            error: error.hypot(self.floor.approach * value) + self.missed * value,
        }
    }

    /// Difference of the last mesh's area between two estimators of the rim. Next to yielding ice
    /// they can agree by chance on one mesh, so the largest difference on three meshes is used,
    /// scaled by the ratio of their cells.
    fn area_off(&self) -> f64 {
        let meshes = if self.is_fixed() { 3 } else { 1 };
        let off = |mesh: &MeshValue| mesh.value * mesh.cells / self.area.cells();
        let last = self.area_off.iter().rev().take(meshes);
        last.map(off).fold(0.0, f64::max)
    }

    /// Whether the ice's hardness fixes the peak.
    fn is_fixed(&self) -> bool {
        self.last
            .is_some_and(|last| last.p_max >= self.hardness * (1.0 - 1e-9))
    }

    /// The limit of the approach. Where the pressure jumps from the hardness to 0 at the rim, the
    /// approach depends on the position of the rim between nodes as much as on the cells.
    fn approach(&self) -> Measure {
        if self.is_fixed() {
            self.approach.last_at_rim(MAX_ORDER)
        } else {
            self.approach.last()
        }
    }

    /// The error of the last mesh's length or width.
    ///
    /// The error is at least [`RIM_SHARE`] of a cell at each end without yielding ice, even if
    /// meshes agree. At an end with yielding ice it is between one third and two thirds of a cell:
    /// the root mean square error of the widths and lengths of 180 contacts was a third of that,
    /// three of these 360 exceeded it, and the worst was 1.3 times as large.
    fn extent_error(&self, extent: &Sequence, off: f64) -> f64 {
        let cell = 0.5 * extent.value() / extent.cells();
        let found = if self.is_fixed() {
            extent.range().max(off).clamp(cell / 1.5, cell / 0.75)
        } else {
            rims_error(extent, off).max(2.0 * RIM_SHARE * cell)
        };
        found.hypot(0.5 * self.floor.peak * extent.value())
    }

    fn of(&self, peak: Measure) -> Option<Limits> {
        let last = self.last?;
        let [_, length_off, width_off] = last.uncertainty;
        let mut area_error = rims_error(&self.area, self.area_off());
        if !self.is_fixed() {
            let cells = [&self.length, &self.width].map(|extent| RIM_SHARE / extent.cells());
            area_error = area_error.max(cells[0].hypot(cells[1]) * last.area);
        }
        let area_error = area_error.hypot(self.floor.peak * last.area);
        let length_error = self.extent_error(&self.length, length_off);
        let (value, error, relative) = if self.is_fixed() {
            (self.hardness, 0.0, AREA_WEIGHT * area_error / last.area)
        } else {
            let value = peak.value.min(self.hardness);
            // This error has one sign on all meshes and is not seen by their comparison: it is
            // added.
            let error = peak.error.hypot(self.floor.peak * value) + self.missed * value;
            (value, error, error / value)
        };
        let mesh = self.approach.value();
        let Measure {
            value: approach,
            error: by_meshes,
        } = self.approach();
        let tilt_error = |figure: &Sequence| figure.last().error_of(figure.value());
        Some(Limits {
            peak: Measure { value, error },
            approach: Measure {
                value: approach,
                error: by_meshes.hypot(self.floor.approach * mesh) + self.missed * mesh,
            },
            area_error,
            length_error,
            width_error: self.extent_error(&self.width, width_off),
            tilt_errors: self.tilt.each_ref().map(tilt_error),
            relative,
        })
    }
}

/// The error of the last mesh's area, length or width: the distance from the limit, and at least
/// the range of the meshes and the difference of two estimators of the rim, since rims of coarse
/// meshes can seem to converge.
fn rims_error(figure: &Sequence, off: f64) -> f64 {
    let by_limit = figure.last().error_of(figure.value());
    by_limit.max(figure.range()).max(off)
}

// The largest shear under the peak pressure, from a sequence of meshes.

/// The largest shear and its depth, mesh by mesh.
pub(crate) struct ShearHistory {
    shear: Sequence,
    depth: Sequence,
}

impl ShearHistory {
    pub fn new() -> Self {
        ShearHistory {
            shear: Sequence::new(Settling::Alternating),
            depth: Sequence::new(Settling::Alternating),
        }
    }

    /// Adds a mesh: finer and similar to the last one, or `graded_anew`. One whose shear is largest
    /// at an end of the line gives no value, and the sequence begins again.
    pub fn push(&mut self, largest: Option<LargestShear>, cells: f64, graded_anew: bool) {
        let Some(LargestShear { value, depth }) = largest else {
            *self = ShearHistory::new();
            return;
        };
        self.shear.push(MeshValue { cells, value }, graded_anew);
        let value = depth;
        self.depth.push(MeshValue { cells, value }, graded_anew);
    }

    /// The limit of the shear, and the last mesh's depth, with their errors. These include the
    /// relative errors that refinement does not reduce: `floor`, which is independent, and
    /// `missed`, which has one sign on all meshes. `None` if the last mesh gives no value.
    pub fn under_peak(&self, floor: f64, missed: f64) -> Option<UnderPeak> {
        let depth = self.depth.value();
        if depth.is_nan() {
            return None;
        }
        let shear = self.shear.last();
        let total = |error: f64, value: f64| error.hypot(floor * value) + missed * value;
        Some(UnderPeak {
            shear: shear.value,
            shear_error: total(shear.error, shear.value),
            depth,
            depth_error: total(self.depth.last().error_of(depth), depth),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Place = Place {
        approach: 1e-6,
        tilt: [0.0; 2],
        missed: 0.0,
        at_ridge: false,
    };

    /// A mesh of so many cells whose figures have errors of second order, in parts of their limits
    /// 30e6 Pa, 1 m2 and 0.1 m.
    fn pushed(watched: &mut FigureHistory, cells: f64, parts: [f64; 3]) {
        let of = |limit: f64, part: f64| limit * (1.0 + part / (cells * cells));
        let figures = Figures {
            p_max: of(30e6, parts[0]).min(watched.hardness),
            area: of(1.0, parts[1]),
            length: of(0.1, parts[2]),
            width: 0.01,
            uncertainty: [0.0; 3],
        };
        watched.push(figures, PLACE, [cells; 3], false);
    }

    #[test]
    fn meshes_without_contact_have_no_limits() {
        let mut watched = FigureHistory::new(None, ErrorFloor::default());
        let none = Figures {
            p_max: 0.0,
            area: 0.0,
            length: 0.0,
            width: 0.0,
            uncertainty: [0.0; 3],
        };
        for cells in [3.0, 4.0, 6.0] {
            watched.push(none, PLACE, [cells; 3], false);
        }
        assert!(watched.limits().is_none());
    }

    #[test]
    fn where_hardness_fixes_the_peak_the_area_is_watched() {
        let mut watched = FigureHistory::new(Some(20e6), ErrorFloor::default());
        pushed(&mut watched, 3.0, [0.5, 0.5, -1.0]);
        assert!(watched.limits().is_none());
        assert_eq!(watched.last().relative, f64::INFINITY);
        pushed(&mut watched, 4.0, [0.5, 0.5, -1.0]);
        pushed(&mut watched, 6.0, [0.5, 0.5, -1.0]);
        let limits = watched.limits().expect("three meshes");
        assert_eq!((limits.peak.value, limits.peak.error), (20e6, 0.0));
        // The length is off by 1/36 and the area by half of that: both are seen, and not stated
        // many times too large.
        let (area, length) = (limits.area_error, limits.length_error / 0.1);
        assert!(length > 1.0 / 36.0 && length < 0.15, "{limits:?}");
        assert!(area > 0.5 / 36.0 && area < 0.07, "{limits:?}");
        assert!((limits.relative / (AREA_WEIGHT * area) - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_rim_beyond_ice_that_yields_is_known_to_two_thirds_of_a_cell_whatever_coarser_meshes_say() {
        let of = |hardness: f64| {
            let mut watched = FigureHistory::new(Some(hardness), ErrorFloor::default());
            for (cells, off) in [(3.0, 0.0), (4.0, 0.3), (6.0, -0.6)] {
                pushed(&mut watched, cells, [0.5, 0.5, off * cells * cells]);
            }
            let limits = watched.limits().expect("three meshes");
            limits.length_error / watched.length.value() * 2.0 * watched.length.cells()
        };
        // Of these lengths: two thirds of a cell of the finest mesh at either end, and where
        // nothing yields three times their range.
        assert!((of(20e6) - 4.0 / 3.0).abs() < 1e-12);
        assert!(of(1e9) > 20.0);
    }

    #[test]
    fn lengths_of_many_asperities_beyond_ice_that_yields_are_known_to_their_own_cells() {
        let mut watched = FigureHistory::of_asperities(Some(20e6));
        let mut stated = [0.0; 2];
        for (cells, length) in [(3.0, 0.098), (4.0, 0.102), (6.0, 0.1)] {
            // 50 asperities along and 5 across.
            let fineness = [cells, 50.0 * cells, 5.0 * cells];
            let figures = Figures {
                p_max: 20e6,
                area: 1.0,
                length,
                width: 0.1 * length,
                uncertainty: [0.0; 3],
            };
            watched.push(figures, PLACE, fineness, false);
            let limits = watched.last();
            stated = [limits.length_error, limits.width_error];
        }
        // Cells of 0.1 / 600 and 0.01 / 60, and two thirds of one at either end.
        for (found, cell) in stated.into_iter().zip([0.1 / 600.0, 0.01 / 60.0]) {
            assert!(
                (found / (4.0 / 3.0 * cell) - 1.0).abs() < 1e-12,
                "{stated:?}"
            );
        }
    }

    #[test]
    fn a_peak_below_the_hardness_is_watched_itself_and_never_extrapolated_beyond() {
        let mut watched = FigureHistory::new(Some(30.001e6), ErrorFloor::default());
        pushed(&mut watched, 3.0, [-0.5, 0.5, -1.0]);
        pushed(&mut watched, 4.0, [-0.5, 0.5, -1.0]);
        pushed(&mut watched, 6.0, [-0.45, 0.5, -1.0]);
        let limits = watched.limits().expect("three meshes");
        assert!(limits.peak.value <= 30.001e6 && limits.peak.error > 0.0);
        assert!((limits.relative - limits.peak.error / limits.peak.value).abs() < 1e-12);
    }

    #[test]
    fn meshes_graded_anew_have_their_spread_until_three_are_similar() {
        let mut watched = FigureHistory::new(None, ErrorFloor::default());
        let add = |watched: &mut FigureHistory, cells: f64, p_max: f64, anew: bool| {
            let figures = Figures {
                p_max,
                area: 1.0,
                length: 0.1,
                width: 0.01,
                uncertainty: [0.0; 3],
            };
            watched.push(figures, PLACE, [cells; 3], anew);
        };
        for p_max in [90.0, 95.0, 96.0] {
            add(&mut watched, 4.0, p_max, true);
        }
        // As many cells each time: nothing is known of finer ones.
        assert!(watched.limits().is_none());
        add(&mut watched, 6.0, 98.0, false);
        let limits = watched.limits().expect("two resolutions");
        assert_eq!((limits.peak.value, limits.peak.error), (98.0, 9.0));
        add(&mut watched, 8.0, 98.8, false);
        let limits = watched.limits().expect("three similar meshes");
        assert!(
            limits.peak.value > 98.8 && limits.peak.error < 3.0,
            "{limits:?}"
        );
    }
}
