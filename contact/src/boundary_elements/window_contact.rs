//! A contact on the cells of one window, and the window that fits it.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::boundary_elements::active_set::{Criteria, Plane, PressureState, press};
use crate::boundary_elements::operator::{LayerCorrection, Operator};
use crate::boundary_elements::window::{CheckUnavailable, Surface, Window};
use crate::problem::check::CheckedProblem;
use crate::result::measure::PressureField;
use crate::result::rim::RimEstimator;
use crate::symmetry::images;

/// Largest number of windows.
pub(super) const MAX_WINDOWS: usize = 24;

/// A contact on one window's cells.
pub(super) struct WindowContact {
    pub window: Window,
    pub plane: Plane,
    pub pressed: PressureState,
}

/// Data that the grids of a problem share.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub checked: &'a CheckedProblem<'a>,
    pub surface: &'a Surface,
    pub precision: Criteria,
}

impl Search<'_> {
    /// The contact on a window that fits it. The window is divided by `divided` after each change;
    /// the first one has this number of cells each way.
    pub fn fitted(
        &self,
        cells: usize,
        divided: impl Fn(Window) -> Window,
    ) -> Result<WindowContact, CheckUnavailable> {
        let modulus = 1.0 / self.surface.compliance;
        let CheckedProblem { problem, gap, .. } = self.checked;
        let mut window =
            Window::first(problem, gap, modulus, cells).ok_or(CheckUnavailable::NotSettled)?;
        for _ in 0..MAX_WINDOWS {
            let found = self.solved(divided(window), None)?;
            match found.window.fitted(found.touched()) {
                Some(next) => window = next,
                None => return Ok(found),
            }
        }
        Err(CheckUnavailable::NotSettled)
    }

    /// The contact on the cells of a window, from initial pressures if given.
    pub fn solved(
        &self,
        window: Window,
        start: Option<Vec<f64>>,
    ) -> Result<WindowContact, CheckUnavailable> {
        let options = self.checked.options;
        let plane = Plane::new(self.checked.problem, &self.checked.gap, &window);
        let mut operator = Operator::new(&window, self.surface)?;
        let pressed = press(&plane, &mut operator, start, self.precision, options)?;
        Ok(WindowContact {
            window,
            plane,
            pressed,
        })
    }
}

impl WindowContact {
    /// Peak pressure [Pa], approach [m], area [m2], length and width [m].
    pub fn figures(&self) -> [f64; 5] {
        let squares = peak(&self.squares(), self.plane.width, self.window.mirrored());
        let p_max = squares.sqrt().min(self.plane.hardness);
        let [area, length, width] = self.extents();
        [p_max, self.approach(), area, length, width]
    }

    /// Largest interpenetration of the undeformed shapes [m].
    pub fn approach(&self) -> f64 {
        let closing: Vec<f64> = (0..self.plane.gap.len())
            .map(|c| self.plane.closing(c, &self.pressed.motion) - self.plane.gap[c])
            .collect();
        peak(&closing, self.plane.width, self.window.mirrored())
    }

    /// The place outside the window with the largest penetration, and that penetration [m],
    /// including the displacements due to the forces within the window.
    pub fn deepest_outside(&self, search: &Search) -> ([f64; 2], f64) {
        let (window, plane) = (&self.window, &self.plane);
        let (gap, surface) = (&search.checked.gap, search.surface);
        let lows = gap.lows().filter(|place| !window.holds(*place));
        let places: Vec<[f64; 2]> = window.outside().chain(lows).collect();
        let depth = |place: &[f64; 2]| plane.depth(gap, &self.pressed.motion, *place);
        let depths = places.into_par_iter().map(|place| (place, depth(&place)));
        let deep: Vec<([f64; 2], f64)> = depths.filter(|(_, depth)| *depth > 0.0).collect();
        let farthest = deep.iter().map(|(place, _)| window.farthest(*place));
        let layers = (!surface.layers.is_empty() && !deep.is_empty())
            .then(|| LayerCorrection::new(&surface.layers, farthest.fold(0.0, f64::max)));
        // A force on a half-space moves its surface by F / (pi E* r).
        let response = |r: f64| {
            surface.compliance / (PI * r) + layers.as_ref().map_or(0.0, |layers| layers.at(r))
        };
        let [dx, dy] = window.size();
        let pressed = self.pressed.pressure.iter().enumerate();
        let forces: Vec<([f64; 2], f64)> = pressed
            .filter(|(_, p)| **p > 0.0)
            .flat_map(|(cell, p)| {
                let [x, y] = window.place(cell);
                let places = images(window.mirrored()).map(move |[s, t]| [s * x, t * y]);
                places.map(move |place| (place, p * dx * dy))
            })
            .collect();
        let lowered = |[x, y]: [f64; 2]| -> f64 {
            let each = forces.iter();
            each.map(|([u, v], force)| force * response((x - u).hypot(y - v)))
                .sum()
        };
        let below: Vec<([f64; 2], f64)> = deep
            .into_par_iter()
            .map(|(place, depth)| (place, depth - lowered(place)))
            .collect();
        let none = ([0.0; 2], 0.0);
        below
            .into_iter()
            .fold(none, |most, next| if next.1 > most.1 { next } else { most })
    }

    /// Area, length and width, from where p^2 reaches zero along the cells' lines.
    fn extents(&self) -> [f64; 3] {
        let all = self.all_cells();
        all.field().extents(&all.pressure, RimEstimator::Shape)
    }

    /// The pressures on all cells of the window.
    pub fn all_cells(&self) -> AllCells {
        let [x, y] = self.window.axes.map(|axis| -> Vec<f64> {
            let centre = |cell: usize| axis.low + (cell as f64 + 0.5) * axis.size();
            (0..axis.cells).map(centre).collect()
        });
        let [dx, dy] = self.window.size();
        let pressure = self.unfolded(&self.pressed.pressure);
        AllCells {
            force: pressure.iter().map(|p| p * dx * dy).collect(),
            sizes: [vec![dx; x.len()], vec![dy; y.len()]],
            x,
            y,
            pressure,
            hardness: self.plane.hardness,
        }
    }

    /// Values of the solved cells on all of them.
    pub fn unfolded(&self, values: &[f64]) -> Vec<f64> {
        let [x, y] = &self.window.axes;
        let row = |j: usize| {
            let start = y.solved_cell(j) * self.plane.width;
            (0..x.cells).map(move |i| values[start + x.solved_cell(i)])
        };
        (0..y.cells).flat_map(row).collect()
    }

    /// Squares of the pressures, which are parabolas along every line of a Hertz contact [Pa^2].
    fn squares(&self) -> Vec<f64> {
        self.pressed.pressure.iter().map(|p| p * p).collect()
    }

    /// Ratio of the largest squared pressure next to an open cell or the window's border to that of
    /// the peak; 0 if the peak is at the hardness.
    pub fn at_rim(&self) -> f64 {
        let squares = self.squares();
        let peak = squares.iter().copied().fold(0.0, f64::max);
        if peak >= self.plane.hardness.powi(2) {
            return 0.0;
        }
        let [nx, ny] = self.window.solved();
        let open = |i: usize, j: usize| i >= nx || j >= ny || squares[j * nx + i] <= 0.0;
        let previous = |at: usize, axis: usize| match at {
            0 if self.window.axes[axis].mirrored => 0,
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
    pub fn patch(&self) -> [f64; 4] {
        let ends = self.touched();
        let [[left, right], [low, high]] = [0, 1].map(|axis| {
            let cells = &self.window.axes[axis];
            let [first, last] = ends[axis].map(|cell| cells.centre(cell));
            if cells.mirrored {
                [-last, last]
            } else {
                [first, last]
            }
        });
        [left, right, low, high]
    }

    /// The pressures at the centres of the cells of another window, 0 outside this one.
    pub fn sampled_on(&self, to: &Window) -> Vec<f64> {
        let width = self.plane.width;
        let columns_and_rows = [0, 1].map(|axis| -> Vec<Option<usize>> {
            let (own, other) = (self.window.axes[axis], to.axes[axis]);
            let cells = 0..to.solved()[axis];
            cells.map(|cell| own.cell(other.centre(cell))).collect()
        });
        let [columns, rows] = &columns_and_rows;
        let at = |i: Option<usize>, j: Option<usize>| {
            i.zip(j)
                .map_or(0.0, |(i, j)| self.pressed.pressure[j * width + i])
        };
        let row = |j: Option<usize>| columns.iter().map(move |&i| at(i, j));
        rows.iter().flat_map(|&j| row(j)).collect()
    }

    /// First and last cell of the contact along x and y.
    pub fn touched(&self) -> [[usize; 2]; 2] {
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

/// Pressures on all cells of a window, mirror planes unfolded.
pub(super) struct AllCells {
    /// Centres of the cells along x [m].
    pub x: Vec<f64>,
    /// Centres of the cells along y [m].
    pub y: Vec<f64>,
    /// Pressures, x fastest [Pa].
    pub pressure: Vec<f64>,
    /// Forces of the cells [N].
    pub force: Vec<f64>,
    /// Sizes of the cells along x and y [m].
    sizes: [Vec<f64>; 2],
    hardness: f64,
}

impl AllCells {
    /// The field of these pressures.
    pub fn field(&self) -> PressureField<'_> {
        PressureField {
            nodes: [&self.x, &self.y],
            force: &self.force,
            gap: None,
            lumped: self.sizes.each_ref().map(|sizes| &sizes[..]),
            symmetry: [false; 2],
            hardness: self.hardness,
        }
    }
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
