//! Figures of a contact by boundary elements, with their errors.

use rayon::prelude::*;

use crate::accuracy::estimators::Limit;
use crate::boundary_elements::active_set::{Plane, PressureState, press};
use crate::boundary_elements::operator::Operator;
use crate::boundary_elements::window::{CheckUnavailable, Surface, Window};
use crate::problem::check::check;
use crate::problem::gap::Gap;
use crate::result::measure::PressureField;
use crate::result::rim::RimEstimator;
use crate::{Options, Problem, Solution};

/// Figures of a contact from its plane alone.
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
/// Grids that errors are estimated from: the finest that were solved.
const COMPARED: usize = 3;
/// Windows that are tried.
const MOST_WINDOWS: usize = 24;
/// Part of a cell that a rim is read to: of a Hertz contact 0.22 of one at most, over 64 contacts
/// on grids of 32 to 80 cells.
const READ: f64 = 0.25;
/// Largest value that the square of a pressure next to the rim may have, of the peak's: in a Hertz
/// contact it is 0.2 on the finest grid.
const STEEP: f64 = 0.4;

/// Solves a contact by boundary elements on its plane: cells of uniform pressure, pressed on a
/// half-space or on bonded layers.
///
/// u = K p with K from A. E. H. Love's rectangles and, for layers, the inverse Hankel transform of
/// what their compliance differs from the half-space's; products by Fourier's functions of a grid
/// padded to twice its size (S. Liu, Q. Wang and G. Liu, Wear 243, 2000). The window of cells is
/// fitted to the contact. Of the method of [`solve`](crate::solve) it uses nothing but the
/// problem's gap. The rim falls between cells, so that figures go to and fro as cells get smaller:
/// the finest grid's are given, and as their error three times the range over three grids, of 20,
/// 24 and 32 cells each way.
///
/// # Errors
/// Why this contact is none for this method, or was not resolved by it.
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

/// As [`boundary_elements`], with grids of 40 to 80 cells too until the estimated error of the peak
/// pressure is `tolerance` of it or less.
///
/// Where these do not reach it either, the answer has the error that it has.
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

/// As [`boundary_elements`], of peaks that are narrower than the cells too: no answer there, but
/// what two hulls that differ a little differ by.
///
/// # Errors
/// As [`boundary_elements`] for all else.
pub fn boundary_elements_to_compare(
    problem: &Problem,
) -> Result<BoundaryElements, CheckUnavailable> {
    solved(problem, f64::INFINITY).map(|(found, _)| found)
}

/// Depth of a place outside the window over the approach that counts as contact: with forces that
/// go with its power 3/2, of a thousandth of the load under radii alike.
const DEEP: f64 = 0.01;

/// The figures, and how steep the pressure is at its rim: [`WindowContact::at_rim`].
fn solved(problem: &Problem, tolerance: f64) -> Result<(BoundaryElements, f64), CheckUnavailable> {
    check(problem, &Options::default()).map_err(|_| CheckUnavailable::NotSettled)?;
    let gap = Gap::new(problem).map_err(|_| CheckUnavailable::NotSettled)?;
    let surface = Surface::of(problem)?;
    let search = Search {
        problem,
        gap: &gap,
        surface: &surface,
    };
    let mut last = search.window()?;
    let mut found = vec![last.figures()];
    for cells in &GRIDS[1..] {
        let window = last.window.with_cells(*cells);
        let start = carried(&last.pressed.pressure, &last.window, &window);
        last = search.solved(window, Some(start))?;
        found.push(last.figures());
        if found.len() >= COMPARED && error(&found, 0) <= tolerance * found[found.len() - 1][0] {
            break;
        }
    }
    let [p_max, approach, area, length, width] = found[found.len() - 1];
    if last.elsewhere(&gap, surface.compliance) > DEEP * approach {
        return Err(CheckUnavailable::Elsewhere);
    }
    // Whatever grids say of them, rims are read to a part of a cell.
    let [along, across] = last.window.size().map(|size| 2.0 * READ * size);
    let least = 0.5 * (along * width + across * length);
    let figures = BoundaryElements {
        p_max,
        p_max_error: error(&found, 0),
        approach,
        approach_error: error(&found, 1),
        area,
        area_error: error(&found, 2).max(least),
        length,
        length_error: error(&found, 3).max(along),
        width,
        width_error: error(&found, 4).max(across),
        patch: last.patch(),
    };
    Ok((figures, last.at_rim()))
}

/// The error of a figure by its range over the finest grids, whose values go to and fro.
fn error(found: &[[f64; 5]], figure: usize) -> f64 {
    let finest = &found[found.len().saturating_sub(COMPARED)..];
    let values: Vec<f64> = finest.iter().map(|figures| figures[figure]).collect();
    Limit::of_range(&values).error
}

/// A contact on one window's cells.
struct WindowContact {
    window: Window,
    plane: Plane,
    pressed: PressureState,
}

/// What the grids of a problem share.
struct Search<'a> {
    problem: &'a Problem,
    gap: &'a Gap<'a>,
    surface: &'a Surface,
}

impl Search<'_> {
    /// The contact on the coarsest cells of a window that fits it.
    fn window(&self) -> Result<WindowContact, CheckUnavailable> {
        let modulus = 1.0 / self.surface.compliance;
        let mut window = Window::first(self.problem, self.gap, modulus, GRIDS[0])
            .ok_or(CheckUnavailable::NotSettled)?;
        for _ in 0..MOST_WINDOWS {
            let found = self.solved(window, None)?;
            match window.fitted(found.touched()) {
                Some(next) => window = next,
                None => return Ok(found),
            }
        }
        Err(CheckUnavailable::NotSettled)
    }

    fn solved(
        &self,
        window: Window,
        start: Option<Vec<f64>>,
    ) -> Result<WindowContact, CheckUnavailable> {
        let plane = Plane::new(self.problem, self.gap, &window);
        let mut operator = Operator::new(&window, self.surface)?;
        let pressed = press(&plane, &mut operator, start)?;
        Ok(WindowContact {
            window,
            plane,
            pressed,
        })
    }
}

impl WindowContact {
    /// Peak pressure [Pa], approach [m], area [m2], length and width [m].
    fn figures(&self) -> [f64; 5] {
        let top = |values: &[f64]| peak(values, self.plane.width, self.window.mirrored);
        let closing: Vec<f64> = (0..self.plane.gap.len())
            .map(|c| self.plane.closing(c, &self.pressed.motion) - self.plane.gap[c])
            .collect();
        let p_max = top(&self.squares()).sqrt().min(self.plane.hardness);
        let [area, length, width] = self.extents();
        [p_max, top(&closing), area, length, width]
    }

    /// How deep the hull lies in the ice outside the window, which the pressures lower there as on
    /// a half-space: by p dA / (pi E* r) [m].
    fn elsewhere(&self, gap: &Gap, compliance: f64) -> f64 {
        let (window, plane) = (&self.window, &self.plane);
        let [dx, dy] = window.size();
        let mirrors = window
            .mirrored
            .map(|m| if m { &[1.0, -1.0][..] } else { &[1.0] });
        let lowered = |[x, y]: [f64; 2]| {
            let pressed = self.pressed.pressure.iter().enumerate();
            let sum: f64 = pressed
                .filter(|(_, p)| **p > 0.0)
                .map(|(c, p)| {
                    let u = window.centre(0, c % plane.width);
                    let v = window.centre(1, c / plane.width);
                    let copies = mirrors[0]
                        .iter()
                        .flat_map(|s| mirrors[1].iter().map(move |t| (x - s * u).hypot(y - t * v)));
                    p * copies.map(|r| 1.0 / r).sum::<f64>()
                })
                .sum();
            sum * dx * dy * compliance / std::f64::consts::PI
        };
        let deep = |place: [f64; 2]| match plane.depth(gap, &self.pressed.motion, place) {
            depth if depth > 0.0 => depth - lowered(place),
            _ => 0.0,
        };
        let lows = gap.lows().filter(|place| !window.holds(*place));
        window.outside().chain(lows).map(deep).fold(0.0, f64::max)
    }

    /// Area, length and width, from where p^2 reaches zero along the cells' lines.
    fn extents(&self) -> [f64; 3] {
        let cells = self.window.cells;
        let [nx, _] = self.window.solved();
        let centre = |axis: usize, cell: usize| {
            self.window.low[axis] + (cell as f64 + 0.5) * self.window.size()[axis]
        };
        // The solved cell that a mirror plane makes a cell of.
        let solved = |axis: usize, cell: usize| {
            let half = cells[axis] / 2;
            if !self.window.mirrored[axis] {
                cell
            } else if 2 * cell < cells[axis] {
                half - 1 - cell
            } else {
                cell - half
            }
        };
        let nodes = [0, 1]
            .map(|axis| -> Vec<f64> { (0..cells[axis]).map(|cell| centre(axis, cell)).collect() });
        let pressure: Vec<f64> = (0..cells[0] * cells[1])
            .map(|c| [c % cells[0], c / cells[0]])
            .map(|[i, j]| self.pressed.pressure[solved(1, j) * nx + solved(0, i)])
            .collect();
        let field = PressureField {
            x: &nodes[0],
            y: &nodes[1],
            force: &[],
            gap: None,
            lumped: [&[], &[]],
            symmetry: [false; 2],
            hardness: self.plane.hardness,
        };
        field.extents(&pressure, RimEstimator::Shape)
    }

    /// Squares of the pressures, which are parabolas along every line of a Hertz contact [Pa^2].
    fn squares(&self) -> Vec<f64> {
        self.pressed.pressure.iter().map(|p| p * p).collect()
    }

    /// Largest square of a pressure next to an open cell or the window's border, over that of the
    /// peak; 0 where hardness cuts the peak off.
    fn at_rim(&self) -> f64 {
        let squares = self.squares();
        let peak = squares.iter().copied().fold(0.0, f64::max);
        if peak >= self.plane.hardness.powi(2) {
            return 0.0;
        }
        let [nx, ny] = self.window.solved();
        let open = |i: usize, j: usize| i >= nx || j >= ny || squares[j * nx + i] <= 0.0;
        let previous = |at: usize, axis: usize| match at {
            0 if self.window.mirrored[axis] => 0,
            _ => at.wrapping_sub(1),
        };
        let rim = (0..squares.len()).filter(|c| {
            let (i, j) = (c % nx, c / nx);
            let across = open(i, j + 1) || open(i, previous(j, 1));
            across || open(i + 1, j) || open(previous(i, 0), j)
        });
        rim.map(|c| squares[c] / peak).fold(0.0, f64::max)
    }

    /// The rectangle `[x_min, x_max, y_min, y_max]` of the middles of the cells in contact [m].
    fn patch(&self) -> [f64; 4] {
        let ends = self.touched();
        let [[left, right], [low, high]] = [0, 1].map(|axis| {
            let [first, last] = ends[axis].map(|cell| self.window.centre(axis, cell));
            if self.window.mirrored[axis] {
                [-last, last]
            } else {
                [first, last]
            }
        });
        [left, right, low, high]
    }

    /// First and last cell of the contact along x and y.
    fn touched(&self) -> [[usize; 2]; 2] {
        let mut ends = [[usize::MAX, 0]; 2];
        let pressure = self.pressed.pressure.iter().enumerate();
        for (c, _) in pressure.filter(|(_, p)| **p > 0.0) {
            let place = [c % self.plane.width, c / self.plane.width];
            for (end, place) in ends.iter_mut().zip(place) {
                *end = [end[0].min(place), end[1].max(place)];
            }
        }
        ends
    }
}

/// Pressures of one window's cells on another's of the same rectangle.
fn carried(pressure: &[f64], from: &Window, to: &Window) -> Vec<f64> {
    let ([nx, ny], [mx, my]) = (from.solved(), to.solved());
    (0..mx * my)
        .map(|c| {
            let (i, j) = ((c % mx) * nx / mx, (c / mx) * ny / my);
            pressure[j * nx + i]
        })
        .collect()
}

/// The largest value on a grid of cells, raised by the vertex of the parabola through its
/// neighbours on each axis.
fn peak(values: &[f64], width: usize, mirrored: [bool; 2]) -> f64 {
    let Some(top) = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])) else {
        return 0.0;
    };
    let cell = values[top];
    let lines = [
        (1, top % width, width),
        (width, top / width, values.len() / width),
    ];
    let rise = |axis: usize| {
        let (stride, place, count) = lines[axis];
        let below = match place {
            0 if mirrored[axis] => cell,
            0 => return 0.0,
            _ => values[top - stride],
        };
        if place + 1 == count {
            return 0.0;
        }
        let above = values[top + stride];
        let (slope, curvature) = (0.5 * (above - below), above - 2.0 * cell + below);
        if curvature < 0.0 && below > 0.0 && above > 0.0 {
            -0.5 * slope * slope / curvature
        } else {
            0.0
        }
    };
    cell + rise(0) + rise(1)
}

// Boundary elements for a family of contacts, where finite elements have said the same at its ends.

/// What boundary elements may be trusted with: contacts between *anchors*, contacts of their kind
/// that finite elements have solved too.
///
/// One runner on one ice under several loads, tracks and rocker radii is a family. At its ends both
/// methods answer. Where each pair of answers lies within both stated errors, boundary elements
/// answer what lies between, and their error is what three grids say, more by the largest
/// difference at an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerifiedBem {
    /// Largest difference of the two peak pressures at an anchor, relative.
    apart: f64,
    /// Relative error of the peak pressure that is requested.
    tolerance: f64,
}

/// Part of the tolerance that the grids at an anchor may leave: what they leave counts as a
/// difference.
const AT_ANCHORS: f64 = 0.5;
/// Largest relative error of an area, as finite elements have it at 0.5 % of the peak: above it
/// finite elements are used.
const AREA: f64 = 0.05;

impl VerifiedBem {
    /// Compares boundary elements with the finite elements' solutions of the same problems; `None`
    /// where they are no method for one of them, where a figure parts by more than both errors, and
    /// where the difference uses up `tolerance`.
    ///
    /// Neither ice that yields nor uneven ice is anchored: what contacts between two of them do may
    /// be like neither.
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

    /// Largest difference of the two peak pressures at an anchor, relative.
    pub fn apart(&self) -> f64 {
        self.apart
    }

    /// The contact by boundary elements, the difference at the anchors in its peak's error; `None`
    /// where that is not within the tolerance, the area is not known to a twentieth or they have no
    /// answer, and finite elements are needed.
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
