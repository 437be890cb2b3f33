//! Contacts of many asperities, solved by boundary elements on a sequence of grids.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::accuracy::estimators::{REFINEMENT, first_resolution, next_refinement};
use crate::accuracy::meshes::MIN_CELLS as MIN_RESOLUTION;
use crate::accuracy::watched::{FigureHistory, Limits, Place};
use crate::boundary_elements::active_set::Criteria;
use crate::boundary_elements::operator::Operator;
use crate::boundary_elements::window::{CellAxis, CheckUnavailable, Surface, Window};
use crate::boundary_elements::window_contact::{AllCells, MAX_WINDOWS, Search, WindowContact};
use crate::grid::grading::storable;
use crate::problem::check::CheckedProblem;
use crate::result::measure::{Figures, ROUNDED};
use crate::{Error, Iterate, Solution, StiffnessForm, SurfaceField};

/// Number of nodes in contact from which the contact plane alone is solved: the cost of finite
/// elements grows with its square.
const MANY: f64 = 4000.0;
/// Number of nodes in contact below which the surroundings of a contact are not searched.
const FEW: f64 = 0.5 * MANY;
/// Smallest number of cells along an axis of a window in the search for contact.
const MIN_CELLS: f64 = 20.0;
/// Largest total number of cells of the first windows, and of those on which asperities are counted.
const FIRST: f64 = 4096.0;
const SCOUTED: f64 = 65_536.0;
/// Convergence criteria in the search, and for the solution.
const ROUGH: Criteria = Criteria {
    residual: 1e-3,
    slack: 1e-3,
};
const FINE: Criteria = Criteria {
    residual: 1e-8,
    slack: 1e-7,
};
/// Open cells around the contact in a window that is refined: initially, and the smallest number,
/// below which the window is fitted again.
const AROUND: f64 = 2.0;
const MIN_AROUND: f64 = 1.0;
/// Open cells around the contact in a window that is fitted again: its cells are finer than those of
/// the first window, and each further fit solves another grid.
const AROUND_AGAIN: f64 = 20.0;
/// Ratio of the depth of a place outside the window to the approach that counts as contact.
const DEEP: f64 = 1e-3;
/// Number of unknowns that a cell counts for: transforms work on a grid padded to twice the cells
/// along either axis.
const PADDED: usize = 4;

/// A contact of many asperities.
pub(crate) struct Asperities<'a> {
    checked: &'a CheckedProblem<'a>,
    surface: Surface,
    /// Distances over which the ice's surface is smooth [m].
    spacing: [f64; 2],
    /// The contact on coarse cells.
    scouted: WindowContact,
    /// Half the mean size of an asperity's contact along x and y [m].
    half: [f64; 2],
}

impl<'a> Asperities<'a> {
    /// The contact of a rigid runner on uneven ice with at least [`MANY`] nodes in contact; `None`
    /// for any other contact.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn of(checked: &'a CheckedProblem<'a>) -> Result<Option<Self>, Error> {
        let options = checked.options;
        let in_volume = options.subsurface
            || options.stiffness == StiffnessForm::Assembled
            || checked.problem.runner.elastic.is_some();
        let surface = checked.problem.ice_surface.as_ref();
        let Some(ice) = surface.filter(|_| !in_volume) else {
            return Ok(None);
        };
        let spacing = ice.spacing();
        let finest = options.cells.map_or_else(
            || REFINEMENT.powi(2) * first_resolution(options.p_max_tolerance, true),
            |cells| cells as f64,
        );
        let scouted = |surface: &Surface| {
            let search = Search {
                checked,
                surface,
                precision: ROUGH,
            };
            let near = search.near(spacing)?;
            let scouted = of_size(near.window, spacing, SCOUTED) == near.window;
            if scouted && near.nodes(near.half_asperity(), finest) < FEW {
                return Ok(None);
            }
            search.scouted(near, spacing).map(Some)
        };
        let found = Surface::of(checked.problem)
            .and_then(|surface| Ok(scouted(&surface)?.map(|found| (surface, found))));
        // Finite elements may solve contacts that boundary elements do not.
        let Some((surface, scouted)) = unless_stopped(found)?.flatten() else {
            return Ok(None);
        };
        let half = scouted.half_asperity();
        let many = scouted.nodes(half, finest) >= MANY;
        Ok(many.then_some(Asperities {
            checked,
            surface,
            spacing,
            scouted,
            half,
        }))
    }

    /// The solution to the requested accuracy, with the grids added to `history`; `None` if the
    /// contact set does not converge on one of them, or no window contains the whole contact.
    ///
    /// # Errors
    /// [`Error::AccuracyNotReached`] if the finest grid allowed is too coarse, [`Error::Unsolved`]
    /// if the coarsest grid has too many cells, [`Error::Stopped`].
    pub fn solve(&self, history: &mut Vec<Iterate>) -> Result<Option<Solution>, Error> {
        let options = self.checked.options;
        let tolerance = options.p_max_tolerance;
        let search = Search {
            checked: self.checked,
            surface: &self.surface,
            precision: FINE,
        };
        let new_figures = || FigureHistory::of_asperities(self.checked.problem.ice.hardness);
        let coarse = &self.scouted.window;
        let mut window = coarse.around(self.scouted.touched(), AROUND);
        let mut wanted = self.coarsest(window);
        let mut figures = new_figures();
        let mut judged: Option<Limits> = None;
        let mut before: Option<WindowContact> = None;
        let mut windows = 1;
        while windows <= MAX_WINDOWS {
            let (divided, cells) = self.divided(window, wanted);
            let from = before.as_ref().unwrap_or(&self.scouted);
            let error_before = judged.map(|limits| limits.relative);
            if figures.similar() == 0 {
                let [nx, ny] = divided.solved();
                storable([2 * nx, 2 * ny, 1])?;
            }
            let found = self.on_grid(&search, (from, divided), error_before, history)?;
            let Some((contact, read)) = found else {
                return Ok(None);
            };
            let touched = contact.touched();
            if !window.contains(&contact.window.around(touched, MIN_AROUND)) {
                window = contact.window.around(touched, AROUND_AGAIN);
                windows += 1;
                before = Some(contact);
                continue;
            }
            let place = Place {
                approach: contact.approach(),
                tilt: self.tilt(&contact),
                missed: 0.0,
                at_ridge: false,
            };
            let [dx, dy] = contact.window.size();
            let Figures { length, width, .. } = read.figures;
            let fineness = [cells, 0.5 * length / dx, 0.5 * width / dy];
            figures.push(read.figures, place, fineness, false);
            judged = figures.limits();
            let reached = match judged {
                _ if options.cells.is_some() => Some(figures.unjudged()),
                limits => limits.filter(|limits| limits.relative <= tolerance),
            };
            wanted *= match judged {
                Some(limits) => next_refinement(limits.relative / tolerance),
                None => REFINEMENT,
            };
            let next = PADDED * self.divided(window, wanted).0.count();
            if reached.is_none() && next <= options.max_dofs {
                before = Some(contact);
                continue;
            }
            // The last grid of this window: is it the whole contact?
            let around = unless_stopped(search.touched_around(&contact, self.spacing))?;
            let Some(wider) = around else {
                return Ok(None);
            };
            if let Some(wider) = wider {
                window = wider;
                windows += 1;
                // Grids without that place belong to another contact.
                wanted = self.coarsest(window);
                figures = new_figures();
                judged = None;
                before = Some(contact);
                continue;
            }
            if let Some(limits) = reached {
                return Ok(Some(self.solution(&contact, read, limits, history)));
            }
            let limits = judged.unwrap_or_else(|| figures.last());
            let best = self.solution(&contact, read, limits, history);
            return Err(Error::AccuracyNotReached {
                dofs: best.dofs,
                estimate: limits.relative,
                tolerance,
                finest: 1.0,
                best: Box::new(best),
            });
        }
        Ok(None)
    }

    /// The contact on a grid, starting from a coarser one, announced before and recorded after;
    /// `None` if it does not converge.
    fn on_grid(
        &self,
        search: &Search,
        (from, grid): (&WindowContact, Window),
        error_before: Option<f64>,
        history: &mut Vec<Iterate>,
    ) -> Result<Option<(WindowContact, Read)>, Error> {
        let (level, dofs) = (history.len(), grid.count());
        let options = self.checked.options;
        options.announce(level, dofs, error_before);
        let start = from.sampled_on(&grid);
        let Some(contact) = unless_stopped(search.solved(grid, Some(start)))? else {
            return Ok(None);
        };
        let read = contact.read();
        let iterate = Iterate {
            level,
            dofs,
            error_before,
            contact_nodes: contact.touching(),
            iterations: contact.pressed.steps,
            residual: contact.violation(),
            p_max: read.figures.p_max,
            sweeps: 0,
            accelerations: contact.pressed.sets,
            energy: contact.energy(),
        };
        if let Some(watcher) = &options.progress {
            watcher(&iterate);
        }
        history.push(iterate);
        Ok(Some((contact, read)))
    }

    /// Cells over half an asperity's contact of a window's first grid, so few that the limit of
    /// unknowns allows two more grids for an error estimate.
    fn coarsest(&self, window: Window) -> f64 {
        let options = self.checked.options;
        if let Some(cells) = options.cells {
            return cells as f64;
        }
        let third = |first: f64| self.divided(window, REFINEMENT.powi(2) * first).0.count();
        let mut first = first_resolution(options.p_max_tolerance, true);
        while PADDED * third(first) > options.max_dofs && first > MIN_RESOLUTION {
            first = (0.95 * first).max(MIN_RESOLUTION);
        }
        first
    }

    /// The window with about `wanted` cells over half an asperity's contact, in numbers that are
    /// fast to transform, and the actual number over half an asperity's contact.
    fn divided(&self, window: Window, wanted: f64) -> (Window, f64) {
        let mut finer = 1.0;
        let cells = [0, 1].map(|axis| {
            let CellAxis { mirrored, .. } = window.axes[axis];
            let least = wanted * window.axes[axis].length() / self.half[axis];
            let cells = fast(least.ceil().max(MIN_CELLS) as usize, mirrored);
            finer *= cells as f64 / least;
            cells
        });
        (window.with_cells(cells), wanted * finer.sqrt())
    }

    /// Pitch and roll of a contact [rad].
    fn tilt(&self, contact: &WindowContact) -> [f64; 2] {
        let [_, pitch, roll] = contact.plane.motion(&contact.pressed.motion);
        self.checked.gap.tilt(pitch, roll)
    }

    /// The solution from a contact and the limits of fine cells.
    fn solution(
        &self,
        contact: &WindowContact,
        read: Read,
        limits: Limits,
        history: &mut Vec<Iterate>,
    ) -> Solution {
        let all = read.all;
        let Figures {
            p_max,
            area,
            length,
            width,
            ..
        } = read.figures;
        let fz = all.force.iter().sum::<f64>();
        let nx = all.x.len();
        let centre_of_pressure = [0, 1].map(|axis| {
            let at = |n: usize| [all.x[n % nx], all.y[n / nx]][axis];
            let forces = all.force.iter().enumerate();
            forces.map(|(n, f)| f * at(n)).sum::<f64>() / fz
        });
        let [pitch, roll] = self.tilt(contact);
        let bound = ROUNDED * contact.plane.hardness;
        let gap = contact.unfolded(&contact.pressed.deformed_gap);
        let cells = all.pressure.iter().zip(&gap);
        let yielded = cells.map(|(p, gap)| if *p >= bound { -gap } else { 0.0 });
        let yielded = yielded.collect();
        let displacement = contact.unfolded(&contact.pressed.displacement);
        Solution {
            p_max: limits.peak.value,
            p_max_error: limits.peak.error,
            p_max_mesh: p_max,
            hardness: self.checked.problem.ice.hardness,
            p_mean: fz / area,
            p_mean_error: fz / area * limits.area_error / area,
            area,
            area_error: limits.area_error,
            length,
            length_error: limits.length_error,
            width,
            width_error: limits.width_error,
            approach: limits.approach.value,
            approach_error: limits.approach.error,
            pitch,
            pitch_error: limits.tilt_errors[0],
            roll,
            roll_error: limits.tilt_errors[1],
            under_peak: None,
            fz,
            centre_of_pressure,
            kkt_residual: contact.violation(),
            dofs: contact.plane.gap.len(),
            iterations: contact.pressed.steps,
            history: std::mem::take(history),
            surface: SurfaceField {
                x: all.x,
                y: all.y,
                pressure: all.pressure,
                yielded,
                gap,
                uz: displacement.iter().map(|u| -u).collect(),
            },
            volume: None,
            runner_volume: None,
            symmetry: contact.window.mirrored(),
            assembled: Vec::new(),
        }
    }
}

/// The result; `None` if boundary elements do not apply or do not converge.
///
/// # Errors
/// [`Error::Stopped`].
fn unless_stopped<T>(found: Result<T, CheckUnavailable>) -> Result<Option<T>, Error> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(CheckUnavailable::Stopped) => Err(Error::Stopped),
        Err(_) => Ok(None),
    }
}

/// Smallest number of cells, at least `least`, whose transforms are fast: without prime factors
/// above 5, and even if a mirror plane halves them.
fn fast(least: usize, even: bool) -> usize {
    let smooth = |n: &usize| {
        let mut rest = *n;
        for factor in [2, 3, 5] {
            while rest.is_multiple_of(factor) {
                rest /= factor;
            }
        }
        rest == 1 && !(even && n % 2 == 1)
    };
    (least..).find(smooth).unwrap_or(least)
}

// Search for the contact of asperities on coarse cells.

impl Search<'_> {
    /// The contact on few cells, of the size of the surface's structure if these are few enough.
    fn near(&self, spacing: [f64; 2]) -> Result<WindowContact, CheckUnavailable> {
        self.fitted(MIN_CELLS as usize, |window| {
            self.announced(of_size(window, spacing, FIRST))
        })
    }

    /// The contact on more cells of that size, in a window outside of which there is no contact.
    fn scouted(
        &self,
        near: WindowContact,
        spacing: [f64; 2],
    ) -> Result<WindowContact, CheckUnavailable> {
        let (mut window, mut found) = (near.window, near);
        for _ in 0..MAX_WINDOWS {
            let finer = of_size(window, spacing, SCOUTED);
            if finer != found.window {
                found = self.solved(self.announced(finer), Some(found.sampled_on(&finer)))?;
            }
            if let Some(next) = found.window.fitted(found.touched()) {
                window = next;
            } else if let Some(wider) = self.touched_around(&found, spacing)? {
                window = wider;
            } else {
                return Ok(found);
            }
        }
        Err(CheckUnavailable::NotSettled)
    }

    /// A window that is about to be solved on the way to the first grid.
    fn announced(&self, window: Window) -> Window {
        self.checked.options.announce(0, window.count(), None);
        window
    }

    /// The window extended by places in contact around it, on cells of about this size; `None` if
    /// there are none.
    fn touched_around(
        &self,
        found: &WindowContact,
        size: [f64; 2],
    ) -> Result<Option<Window>, CheckUnavailable> {
        let (window, pressure) = found.coarsened(size);
        let (wide, first) = window.surroundings();
        let width = wide.solved()[0];
        let mut all = vec![0.0; wide.count()];
        for (j, row) in pressure.chunks_exact(window.solved()[0]).enumerate() {
            let start = (first[1] + j) * width + first[0];
            all[start..start + row.len()].copy_from_slice(row);
        }
        let mut displacement = vec![0.0; all.len()];
        Operator::new(&wide, self.surface)?.apply(&all, &mut displacement);
        let least = DEEP * found.approach();
        let gap = &self.checked.gap;
        let depth = |place| found.plane.depth(gap, &found.pressed.motion, place);
        let touches = |cell: &usize| {
            all[*cell] == 0.0 && depth(wide.place(*cell)) - displacement[*cell] > least
        };
        let touching = (0..all.len()).into_par_iter().filter(touches);
        let touching: Vec<usize> = touching.collect();
        let (place, below) = found.deepest_outside(self);
        let elsewhere = Some(place).filter(|_| below > least);
        let places = touching.into_iter().map(|cell| wide.place(cell));
        let wider = places
            .chain(elsewhere)
            .fold(found.window, |wider, place| wider.with_place(place));
        Ok((!found.window.contains(&wider)).then_some(wider))
    }
}

/// A window with cells of this size, or of larger cells of the same shape if there would be more
/// than `most`.
fn of_size(window: Window, size: [f64; 2], most: f64) -> Window {
    let cells = |coarser: f64| {
        [0, 1].map(|axis| (window.axes[axis].length() / (coarser * size[axis])).max(MIN_CELLS))
    };
    // If one axis has its smallest number of cells, only the other is coarsened.
    let mut coarser = 1.0;
    while cells(coarser).iter().product::<f64>() > most {
        coarser *= 1.25;
    }
    let cells = [0, 1].map(|axis| fast(cells(coarser)[axis] as usize, window.axes[axis].mirrored));
    window.with_cells(cells)
}

// Pressures, forces and figures of a contact.

/// A contact on all cells of its window, and its figures.
struct Read {
    all: AllCells,
    figures: Figures,
}

impl WindowContact {
    fn read(&self) -> Read {
        let all = self.all_cells();
        let [dx, dy] = self.window.size();
        let mut figures = all.field().figures(&all.pressure);
        // The area of the cells in contact is too large, as the outermost cells are only partly in
        // contact; the area from chords is too small for short chords. The exact area is between.
        let counted = all.force.iter().filter(|f| **f > 0.0).count() as f64 * dx * dy;
        figures.uncertainty[0] = (0.5 * (counted - figures.area).abs()).max(figures.uncertainty[0]);
        figures.area = 0.5 * (counted + figures.area);
        Read { all, figures }
    }

    /// Number of nodes in contact on a mesh with `cells` over half of an asperity's contact, of
    /// this half size [m].
    fn nodes(&self, half: [f64; 2], cells: f64) -> f64 {
        let size = self.window.size();
        let finer = [0, 1].map(|axis| cells * size[axis] / half[axis]);
        self.touching() as f64 * finer[0] * finer[1]
    }

    /// The forces on cells of this size in the window, or of the window's own size if that is
    /// larger.
    fn coarsened(&self, size: [f64; 2]) -> (Window, Vec<f64>) {
        let coarse = of_size(self.window, size, SCOUTED);
        let cells = [0, 1].map(|axis| coarse.cells()[axis].min(self.window.cells()[axis]));
        let coarse = self.window.with_cells(cells);
        let width = coarse.solved()[0];
        let part = coarse.count() as f64 / self.window.count() as f64;
        let mut pressure = vec![0.0; coarse.count()];
        let own = self.pressed.pressure.iter().enumerate();
        for (cell, p) in own.filter(|(_, p)| **p > 0.0) {
            let [x, y] = self.window.place(cell);
            if let (Some(i), Some(j)) = (coarse.axes[0].cell(x), coarse.axes[1].cell(y)) {
                pressure[j * width + i] += part * p;
            }
        }
        (coarse, pressure)
    }

    /// Solved cells in contact.
    fn touching(&self) -> usize {
        self.pressed.pressure.iter().filter(|p| **p > 0.0).count()
    }

    /// Half the mean size of an asperity's contact along x and y [m]: the half axis of an ellipse
    /// whose chords have the mean length of the stretches in contact.
    fn half_asperity(&self) -> [f64; 2] {
        let [nx, ny] = self.window.cells();
        let all = self.unfolded(&self.pressed.pressure);
        let touches: Vec<bool> = all.iter().map(|p| *p > 0.0).collect();
        let count = touches.iter().filter(|t| **t).count() as f64;
        let starts = |stride: usize, place: &dyn Fn(usize) -> usize| {
            let starts = |n: &usize| touches[*n] && (place(*n) == 0 || !touches[*n - stride]);
            (0..nx * ny).filter(starts).count().max(1) as f64
        };
        let stretches = [starts(1, &|n| n % nx), starts(nx, &|n| n / nx)];
        let size = self.window.size();
        [0, 1].map(|axis| 0.5 * 4.0 / PI * count / stretches[axis] * size[axis])
    }

    /// Complementary energy of the pressures, the work of a load from first touch [J].
    fn energy(&self) -> f64 {
        let plane = &self.plane;
        let lowest = if plane.balance.is_empty() {
            0.0
        } else {
            plane.gap.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let pressures = self.pressed.pressure.iter();
        let cells = pressures.zip(&plane.gap).zip(&self.pressed.displacement);
        let pressed = cells.filter(|((p, _), _)| **p > 0.0);
        let sum: f64 = pressed.map(|((p, g), u)| p * (g - lowest + 0.5 * u)).sum();
        let [dx, dy] = self.window.size();
        self.window.image_count() * dx * dy * sum
    }

    /// Largest relative violation of the contact conditions and of the load's balance.
    fn violation(&self) -> f64 {
        let (plane, pressed) = (&self.plane, &self.pressed);
        let violated = |c: usize| match pressed.pressure[c] {
            p if p >= plane.hardness => pressed.deformed_gap[c].max(0.0),
            p if p > 0.0 => pressed.deformed_gap[c].abs(),
            _ => (-pressed.deformed_gap[c]).max(0.0),
        };
        let gaps = (0..plane.gap.len()).map(violated).fold(0.0, f64::max) / self.approach();
        let rows = plane.motions.iter().zip(&plane.balance);
        let unbalanced = rows.map(|(row, balance)| {
            let terms = || row.iter().zip(&pressed.pressure).map(|(n, p)| n * p);
            let size: f64 = terms().map(f64::abs).sum();
            (terms().sum::<f64>() - balance).abs() / size
        });
        unbalanced.fold(gaps, f64::max)
    }
}
