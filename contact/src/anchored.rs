//! Boundary elements for a family of contacts, where finite elements have said the same at its ends.

use rayon::prelude::*;

use crate::boundary_elements::{BoundaryElements, boundary_elements_to};
use crate::{Problem, Solution};

/// What boundary elements may be trusted with: contacts between *anchors*, contacts of their kind that finite elements have solved too.
///
/// One runner on one ice under several loads, tracks and rocker radii is a family. At its ends both methods answer. Where each pair of
/// answers lies within both stated errors, boundary elements answer what lies between, and their error is what three grids say,
/// more by the largest difference at an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchored {
    /// Largest difference of the two peak pressures at an anchor, relative.
    apart: f64,
    /// Relative error of the peak pressure that is asked.
    tolerance: f64,
}

/// Part of the tolerance that the grids at an anchor may leave: what they leave counts as a difference.
const AT_ANCHORS: f64 = 0.5;
/// Largest relative error of an area, as finite elements have it at 0.5 % of the peak: beyond it finite elements are asked.
const AREA: f64 = 0.05;

impl Anchored {
    /// Boundary elements beside the finite elements' solutions of the same problems; `None` where they are no method for one of them, where
    /// a figure parts by more than both errors, and where nothing is left of `tolerance`.
    ///
    /// Neither ice that yields nor uneven ice is anchored: what contacts between two of them do may be like neither.
    pub fn at(anchors: &[(Problem, Solution)], tolerance: f64) -> Option<Self> {
        let beside = |(problem, first): &(Problem, Solution)| {
            if problem.ice.hardness.is_some() || problem.ice_surface.is_some() {
                return None;
            }
            let second = boundary_elements_to(problem, AT_ANCHORS * tolerance).ok()?;
            agree(first, &second).then(|| (second.p_max / first.p_max - 1.0).abs())
        };
        let all: Option<Vec<f64>> = anchors.par_iter().map(beside).collect();
        let apart = all?.into_iter().fold(0.0, f64::max);
        (!anchors.is_empty() && apart < tolerance).then_some(Anchored { apart, tolerance })
    }

    /// Largest difference of the two peak pressures at an anchor, relative.
    pub fn apart(&self) -> f64 {
        self.apart
    }

    /// The contact by boundary elements, the difference at the anchors in its peak's error; `None` where that is not within the tolerance, the
    /// area is not known to a twentieth or they have no answer, and finite elements are needed.
    pub fn answer(&self, problem: &Problem) -> Option<BoundaryElements> {
        let mut found = boundary_elements_to(problem, self.tolerance - self.apart).ok()?;
        found.p_max_error += self.apart * found.p_max;
        let enough = found.p_max_error <= self.tolerance * found.p_max
            && found.area_error <= AREA * found.area;
        enough.then_some(found)
    }
}

/// Whether all figures lie within both errors of one another.
fn agree(first: &Solution, second: &BoundaryElements) -> bool {
    let pairs = [
        [
            first.p_max,
            second.p_max,
            first.p_max_error + second.p_max_error,
        ],
        [
            first.approach,
            second.approach,
            first.approach_error + second.approach_error,
        ],
        [
            first.area,
            second.area,
            first.area_error + second.area_error,
        ],
        [
            first.length,
            second.length,
            first.length_error + second.length_error,
        ],
        [
            first.width,
            second.width,
            first.width_error + second.width_error,
        ],
    ];
    pairs.iter().all(|[a, b, errors]| (a - b).abs() <= *errors)
}
