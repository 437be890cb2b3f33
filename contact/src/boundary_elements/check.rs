//! Figures of a contact by boundary elements, with their errors.

use rayon::prelude::*;

use crate::boundary_elements::active_set::Criteria;
use crate::boundary_elements::window::{CheckUnavailable, Surface};
use crate::boundary_elements::window_contact::Search;
use crate::problem::check::CheckedProblem;
use crate::{Measure, Options, Problem, Solution};

/// Figures of a contact by boundary elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryElements {
    /// Peak pressure [Pa].
    pub p_max: f64,
    /// Estimated discretisation error of the peak pressure [Pa].
    pub p_max_error: f64,
    /// Approach at the deepest place, from first touch [m].
    pub approach: f64,
    /// Estimated error of the approach [m].
    pub approach_error: f64,
    /// Contact area [m2].
    pub area: f64,
    /// Estimated error of the area [m2].
    pub area_error: f64,
    /// Extent of the contact along x [m].
    pub length: f64,
    /// Estimated error of the length [m].
    pub length_error: f64,
    /// Extent of the contact along y [m].
    pub width: f64,
    /// Estimated error of the width [m].
    pub width_error: f64,
    /// The rectangle `[x_min, x_max, y_min, y_max]` of the middles of the cells in contact [m].
    pub patch: [f64; 4],
}

/// Cells along x and y of the grids, from coarse to fine; the first also finds the window.
const GRIDS: [usize; 7] = [20, 24, 32, 40, 48, 64, 80];
/// Number of grids from which errors are estimated: the finest that were solved.
const COMPARED: usize = 3;
/// Error of a rim's position as a fraction of a cell: at most 0.22 in 64 Hertz contacts on grids of
/// 32 to 80 cells.
const RIM_ERROR: f64 = 0.25;
/// Largest ratio of the squared pressure next to the rim to that of the peak: in a Hertz contact it
/// is 0.2 on the finest grid.
const STEEP: f64 = 0.4;

/// Solves a contact by boundary elements on its plane: cells of uniform pressure on a half-space or
/// on bonded layers.
///
/// u = K p with K from A. E. H. Love's solution for a rectangle and, for layers, the inverse Hankel
/// transform of the difference of their compliance from the half-space's. Products use fast Fourier
/// transforms on a grid padded to twice its size (S. Liu, Q. Wang and G. Liu, Wear 243, 2000). The
/// window of cells is fitted to the contact. The method is independent of [`solve`](crate::solve)
/// except for the gap of the problem. The rim lies between cells, so that figures oscillate as
/// cells get smaller. The figures are those of the finest grid; their error is three times the
/// range over three grids, of 20, 24 and 32 cells each way.
///
/// # Errors
/// The reason why the method does not apply to this contact, or did not resolve it.
///
/// ```
/// use std::sync::Arc;
/// use kufe_contact::{Ice, Load, Problem, Runner, Tilt, boundary_elements, hertz};
/// use kufe_mesh::Paraboloid;
///
/// let hull = Arc::new(Paraboloid::new(30.0, 0.005)?);
/// let load = Load::central(1000.0, Tilt::Free);
/// let problem = Problem::new(Runner::rigid(hull), Ice::half_space(9.0e9, 0.33), load);
/// let found = boundary_elements(&problem)?;
/// let exact = hertz(30.0, 0.005, 9.0e9 / (1.0 - 0.33 * 0.33), 1000.0)?;
/// assert!((found.p_max - exact.p_max).abs() < found.p_max_error);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn boundary_elements(problem: &Problem) -> Result<BoundaryElements, CheckUnavailable> {
    boundary_elements_to(problem, f64::INFINITY)
}

/// [`boundary_elements`] with additional grids of 40 to 80 cells, until the estimated relative
/// error of the peak pressure is at most `tolerance`.
///
/// If these do not reach it either, the result is returned with its larger error.
///
/// # Errors
/// As [`boundary_elements`].
pub fn boundary_elements_to(
    problem: &Problem,
    tolerance: f64,
) -> Result<BoundaryElements, CheckUnavailable> {
    match solved(problem, tolerance)? {
        (_, at_rim) if at_rim > STEEP => Err(CheckUnavailable::NarrowPeak),
        (found, _) => Ok(found),
    }
}

/// [`boundary_elements`] without the check for peaks that are narrower than the cells. Such results
/// are only suitable for the difference between two similar hulls.
///
/// # Errors
/// Those of [`boundary_elements`] otherwise.
pub fn boundary_elements_to_compare(
    problem: &Problem,
) -> Result<BoundaryElements, CheckUnavailable> {
    solved(problem, f64::INFINITY).map(|(found, _)| found)
}

/// Criteria of the pressures: far below the error of the grids.
const PRECISION: Criteria = Criteria {
    residual: 1e-6,
    slack: 1e-5,
};
/// Ratio of the depth of a place outside the window to the approach that counts as contact: with
/// forces proportional to the power 3/2 of the depth, a thousandth of the load for equal radii.
const DEEP: f64 = 0.01;

/// The figures, and the steepness of the pressure at its rim, [`WindowContact::at_rim`].
fn solved(problem: &Problem, tolerance: f64) -> Result<(BoundaryElements, f64), CheckUnavailable> {
    let options = Options::default();
    let checked =
        CheckedProblem::new(problem, &options).map_err(|_| CheckUnavailable::NotSettled)?;
    let search = Search {
        checked: &checked,
        surface: &Surface::of(problem)?,
        precision: PRECISION,
    };
    let mut last = search.fitted(GRIDS[0], |window| window)?;
    let mut found = vec![last.figures()];
    for cells in &GRIDS[1..] {
        let window = last.window.with_cells([*cells; 2]);
        last = search.solved(window, Some(last.sampled_on(&window)))?;
        found.push(last.figures());
        if found.len() >= COMPARED && error(&found, 0) <= tolerance * found[found.len() - 1][0] {
            break;
        }
    }
    let [p_max, approach, area, length, width] = found[found.len() - 1];
    let errors = [0, 1, 2, 3, 4].map(|figure| error(&found, figure));
    let [
        p_max_error,
        approach_error,
        area_error,
        length_error,
        width_error,
    ] = errors;
    if last.deepest_outside(&search).1 > DEEP * approach {
        return Err(CheckUnavailable::Elsewhere);
    }
    // The error of a rim is at least a fraction of a cell, even if the grids agree.
    let [along, across] = last.window.size().map(|size| 2.0 * RIM_ERROR * size);
    let least = 0.5 * (along * width + across * length);
    let figures = BoundaryElements {
        p_max,
        p_max_error,
        approach,
        approach_error,
        area,
        area_error: area_error.max(least),
        length,
        length_error: length_error.max(along),
        width,
        width_error: width_error.max(across),
        patch: last.patch(),
    };
    Ok((figures, last.at_rim()))
}

/// The error of a figure from its range over the finest grids, whose values oscillate.
fn error(found: &[[f64; 5]], figure: usize) -> f64 {
    let finest = &found[found.len().saturating_sub(COMPARED)..];
    let values: Vec<f64> = finest.iter().map(|figures| figures[figure]).collect();
    Measure::of_range(&values).error
}

// Boundary elements for a family of contacts, verified at its ends by finite elements.

/// Boundary elements for contacts between *anchors*: contacts of the same family that finite
/// elements have solved, too.
///
/// A family is one runner on one ice under several loads, tracks and rocker radii. Both methods
/// solve its ends. If each pair of results agrees within both stated errors, boundary elements
/// solve the contacts in between. Their error is that from three grids plus the largest difference
/// at an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerifiedBem {
    /// Largest relative difference of the two peak pressures at an anchor.
    apart: f64,
    /// Requested relative error of the peak pressure.
    tolerance: f64,
}

/// Fraction of the tolerance that is requested from the grids at an anchor: their error counts as a
/// difference.
const AT_ANCHORS: f64 = 0.5;
/// Largest relative error of an area, about that of finite elements at 0.5 % of the peak; above it
/// finite elements are used.
const MAX_AREA_ERROR: f64 = 0.05;

impl VerifiedBem {
    /// Compares boundary elements with finite-element solutions of the same problems; `None` if
    /// they do not apply to one of them, if a figure differs by more than both errors, or if the
    /// difference exceeds `tolerance`.
    ///
    /// Yielding ice and uneven ice have no anchors: contacts between two anchors may behave
    /// differently from both.
    pub fn at(anchors: &[(Problem, Solution)], tolerance: f64) -> Option<Self> {
        let difference = |(problem, first): &(Problem, Solution)| {
            if problem.ice.hardness.is_some() || problem.ice_surface.is_some() {
                return None;
            }
            let second = boundary_elements_to(problem, AT_ANCHORS * tolerance).ok()?;
            agree(first, &second).then(|| (second.p_max / first.p_max - 1.0).abs())
        };
        let all: Option<Vec<f64>> = anchors.par_iter().map(difference).collect();
        let apart = all?.into_iter().fold(0.0, f64::max);
        (!anchors.is_empty() && apart < tolerance).then_some(VerifiedBem { apart, tolerance })
    }

    /// Largest relative difference of the two peak pressures at an anchor.
    pub fn apart(&self) -> f64 {
        self.apart
    }

    /// The contact by boundary elements, with the difference at the anchors included in the error
    /// of the peak. `None` if that error exceeds the tolerance, if the error of the area exceeds a
    /// twentieth, or if they do not apply; finite elements are then needed.
    pub fn answer(&self, problem: &Problem) -> Option<BoundaryElements> {
        let mut found = boundary_elements_to(problem, self.tolerance - self.apart).ok()?;
        found.p_max_error += self.apart * found.p_max;
        let enough = found.p_max_error <= self.tolerance * found.p_max
            && found.area_error <= MAX_AREA_ERROR * found.area;
        enough.then_some(found)
    }
}

/// Whether all figures lie within both errors of one another.
fn agree(first: &Solution, second: &BoundaryElements) -> bool {
    let (a, b) = (first, second);
    let pairs = [
        (a.p_max, b.p_max, a.p_max_error + b.p_max_error),
        (a.approach, b.approach, a.approach_error + b.approach_error),
        (a.area, b.area, a.area_error + b.area_error),
        (a.length, b.length, a.length_error + b.length_error),
        (a.width, b.width, a.width_error + b.width_error),
    ];
    let within = |(a, b, errors): &(f64, f64, f64)| (a - b).abs() <= *errors;
    pairs.iter().all(within)
}
