//! Contacts of many asperities: solved on the contact plane alone, on finer and finer cells.

use std::f64::consts::PI;

use crate::accuracy::estimators::{
    Limit, MeshValue, REFINEMENT, first_resolution, next_refinement, range,
};
use crate::accuracy::find_patch::capacity;
use crate::accuracy::watched::{ErrorFloor, FigureHistory, Limits, Place};
use crate::boundary_elements::active_set::{Plane, Precision};
use crate::boundary_elements::operator::Operator;
use crate::boundary_elements::window::{CheckUnavailable, Surface, Window};
use crate::boundary_elements::window_contact::{MOST_WINDOWS, Search, WindowContact, carried};
use crate::problem::check::check;
use crate::problem::gap::Gap;
use crate::result::measure::{Figures, PressureField, ROUNDED};
use crate::{Error, Iterate, NextMesh, Options, Problem, Solution, StiffnessForm, SurfaceField};

/// Touching nodes from which the contact plane alone is solved: the cost of finite elements grows
/// with their square.
const MANY: f64 = 4000.0;
/// Fewest cells along an axis of a window that contact is looked for in, and most cells in all: of
/// the first windows, and of those that asperities are counted on.
const FEWEST: f64 = 20.0;
const FIRST: f64 = 4096.0;
const SCOUTED: f64 = 65_536.0;
/// How well pressures are known there, and where they are the answer.
const ROUGH: Precision = Precision {
    residual: 1e-3,
    slack: 1e-3,
};
const FINE: Precision = Precision {
    residual: 1e-8,
    slack: 1e-7,
};
/// Open cells around the contact in a window that is refined, where it is made and where it has to
/// be made anew.
const AROUND: f64 = 2.0;
const LEAST_AROUND: f64 = 1.0;
/// Depth of a place outside the window over the approach that counts as contact.
const DEEP: f64 = 1e-3;
/// Factor of safety on errors of an order that is assumed, not observed (P.J. Roache, J. Fluids
/// Eng. 116, 405, 1994).
const SAFETY: f64 = 3.0;
/// Unknowns, as limited, for each cell: those of the padded grid.
const PADDED: usize = 4;

/// A contact of many asperities.
pub(crate) struct Asperities<'a> {
    problem: &'a Problem,
    options: &'a Options,
    gap: Gap<'a>,
    surface: Surface,
    /// The contact on coarse cells.
    scouted: WindowContact,
    /// Half the mean size of an asperity's contact along x and y [m].
    half: [f64; 2],
}

impl<'a> Asperities<'a> {
    /// A rigid runner on uneven ice that touches at so many nodes that the contact plane alone is
    /// solved; `None` for any other contact.
    ///
    /// # Errors
    /// Those of a problem that is out of range.
    pub fn of(problem: &'a Problem, options: &'a Options) -> Result<Option<Self>, Error> {
        let in_volume = options.subsurface
            || options.stiffness == StiffnessForm::Assembled
            || problem.runner.elastic.is_some();
        let Some(ice) = problem.ice_surface.as_ref().filter(|_| !in_volume) else {
            return Ok(None);
        };
        check(problem, options)?;
        let gap = Gap::new(problem)?;
        capacity(problem)?;
        let found = Surface::of(problem).and_then(|surface| {
            let search = Search {
                problem,
                gap: &gap,
                surface: &surface,
                precision: ROUGH,
            };
            Ok((search.scouted(ice.spacing())?, surface))
        });
        // What boundary elements do not find, finite elements may.
        let Ok((scouted, surface)) = found else {
            return Ok(None);
        };
        let half = scouted.half_asperity();
        let finest = options.cells.map_or_else(
            || REFINEMENT.powi(2) * first_resolution(options.p_max_tolerance, true),
            |cells| cells as f64,
        );
        let size = scouted.window.size();
        let finer = |axis: usize| finest * size[axis] / half[axis];
        let touching = scouted.touching() as f64 * finer(0) * finer(1);
        Ok((touching >= MANY).then_some(Asperities {
            problem,
            options,
            gap,
            surface,
            scouted,
            half,
        }))
    }

    /// The solution, to the requested accuracy; `None` where the set of cells in contact does not
    /// settle.
    ///
    /// # Errors
    /// [`Error::AccuracyNotReached`] where the finest cells allowed do not do, [`Error::Stopped`].
    pub fn solve(&self) -> Result<Option<Solution>, Error> {
        let options = self.options;
        let search = Search {
            problem: self.problem,
            gap: &self.gap,
            surface: &self.surface,
            precision: FINE,
        };
        let first = || first_resolution(options.p_max_tolerance, true);
        let mut wanted = options.cells.map_or_else(first, |cells| cells as f64);
        let coarse = &self.scouted.window;
        let mut window = coarse.around(self.scouted.touched(), AROUND);
        let mut figures = FigureHistory::new(self.problem.ice.hardness, ErrorFloor::default());
        let mut peaks: Vec<MeshValue> = Vec::new();
        let mut judged: Option<Limits> = None;
        let mut history: Vec<Iterate> = Vec::new();
        let mut before: Option<WindowContact> = None;
        loop {
            let (divided, cells) = self.divided(window, wanted);
            let dofs = divided.solved().iter().product();
            let error_before = judged.map(|limits| limits.relative);
            if PADDED * dofs > options.max_dofs
                && let (Some(contact), Some(limits)) = (&before, judged.or_else(|| figures.last()))
            {
                let best = self.solution(contact, (limits, &figures), history);
                return Err(Error::AccuracyNotReached {
                    dofs: best.dofs,
                    estimate: limits.relative,
                    tolerance: options.p_max_tolerance,
                    finest: 1.0,
                    best: Box::new(best),
                });
            }
            if options.stopped() {
                return Err(Error::Stopped);
            }
            let level = history.len();
            if let Some(watcher) = &options.next_mesh {
                watcher(&NextMesh {
                    level,
                    dofs,
                    error_before,
                });
            }
            let from = before.as_ref().unwrap_or(&self.scouted);
            let start = carried(&from.pressed.pressure, &from.window, &divided);
            let Ok(contact) = search.solved(divided, Some(start)) else {
                return Ok(None);
            };
            let touched = contact.touched();
            if !window.contains(&contact.window.around(touched, LEAST_AROUND)) {
                window = contact.window.around(touched, FEWEST);
                before = Some(contact);
                continue;
            }
            let read = contact.read();
            let place = Place {
                approach: contact.approach(),
                tilt: self.tilt(&contact),
                missed: 0.0,
            };
            figures.push(read.figures, place, cells, false);
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
            if options.cells.is_some() {
                let limits = unjudged(read.figures.p_max, contact.approach());
                return Ok(Some(self.solution(&contact, (limits, &figures), history)));
            }
            let value = read.figures.p_max;
            peaks.push(MeshValue { cells, value });
            judged = figures
                .limits()
                .and_then(|limits| by_first_order(limits, &peaks));
            wanted *= match judged {
                Some(limits) if limits.relative <= options.p_max_tolerance => {
                    return Ok(Some(self.solution(&contact, (limits, &figures), history)));
                }
                Some(limits) => next_refinement(limits.relative / options.p_max_tolerance),
                None => REFINEMENT,
            };
            before = Some(contact);
        }
    }

    /// The window with about so many cells over half an asperity's contact, in numbers that are
    /// fast to transform, and how many that makes.
    fn divided(&self, window: Window, wanted: f64) -> (Window, f64) {
        let mut finer = 1.0;
        let cells = [0, 1].map(|axis| {
            let least = wanted * (window.high[axis] - window.low[axis]) / self.half[axis];
            let cells = fast(least.ceil().max(FEWEST) as usize, window.mirrored[axis]);
            finer *= cells as f64 / least;
            cells
        });
        (window.with_cells(cells), wanted * finer.sqrt())
    }

    /// Pitch and roll of a contact [rad].
    fn tilt(&self, contact: &WindowContact) -> [f64; 2] {
        let [_, pitch, roll] = contact.plane.motion(&contact.pressed.motion);
        self.gap.tilt(pitch, roll)
    }

    /// What a contact and the limits of finer and finer cells make.
    fn solution(
        &self,
        contact: &WindowContact,
        (limits, figures): (Limits, &FigureHistory),
        history: Vec<Iterate>,
    ) -> Solution {
        let read = contact.read();
        let Figures {
            p_max,
            area,
            length,
            width,
            ..
        } = read.figures;
        let fz = read.force.iter().sum::<f64>();
        let nx = read.x.len();
        let moment = |at: &dyn Fn(usize) -> f64| -> f64 {
            read.force.iter().enumerate().map(|(n, f)| f * at(n)).sum()
        };
        let centre_of_pressure = [
            moment(&|n| read.x[n % nx]) / fz,
            moment(&|n| read.y[n / nx]) / fz,
        ];
        let other = figures.other_errors();
        let [pitch, roll] = self.tilt(contact);
        let bound = ROUNDED * contact.plane.hardness;
        let gap = contact.unfolded(&contact.pressed.opening);
        let cells = read.pressure.iter().zip(&gap);
        let yielded = cells.map(|(p, gap)| if *p >= bound { -gap } else { 0.0 });
        let yielded = yielded.collect();
        let last = history.last();
        Solution {
            p_max: limits.peak.value,
            p_max_error: limits.peak.error,
            p_max_mesh: p_max,
            hardness: self.problem.ice.hardness,
            p_mean: fz / area,
            p_mean_error: fz / area * limits.area_error / area,
            area,
            area_error: limits.area_error,
            length,
            length_error: limits.length_error,
            width,
            width_error: other.width_error,
            approach: limits.approach,
            approach_error: other.approach_error,
            pitch,
            pitch_error: other.tilt_errors[0],
            roll,
            roll_error: other.tilt_errors[1],
            under_peak: None,
            fz,
            centre_of_pressure,
            kkt_residual: last.map_or(f64::INFINITY, |last| last.residual),
            dofs: last.map_or(0, |last| last.dofs),
            iterations: last.map_or(0, |last| last.iterations),
            history,
            surface: SurfaceField {
                x: read.x,
                y: read.y,
                pressure: read.pressure,
                yielded,
                gap,
                uz: contact
                    .unfolded(&contact.pressed.sunk)
                    .iter()
                    .map(|u| -u)
                    .collect(),
            },
            volume: None,
            runner_volume: None,
            symmetry: contact.window.mirrored,
            assembled: Vec::new(),
        }
    }
}

/// Limits with the peak of the last grid and its error by the range R of the last three: the
/// highest of many asperities has few cells, and its peak goes to and fro with their places. Errors
/// of first order, the slowest seen, would leave R h3 / (h1 - h3) on the finest cells h3; with a
/// factor of safety. A peak that the ice's hardness fixes has none.
fn by_first_order(limits: Limits, peaks: &[MeshValue]) -> Option<Limits> {
    let [.., first, second, last] = peaks else {
        return None;
    };
    if limits.peak.error == 0.0 {
        return Some(limits);
    }
    let three = [first.value, second.value, last.value];
    let rest = first.cells / (last.cells - first.cells);
    let error = SAFETY * range(&three) * rest;
    Some(Limits {
        peak: Limit {
            value: last.value,
            error,
        },
        relative: error / last.value,
        ..limits
    })
}

/// One grid, without an error estimate.
fn unjudged(p_max: f64, approach: f64) -> Limits {
    Limits {
        peak: Limit {
            value: p_max,
            error: f64::INFINITY,
        },
        approach,
        area_error: f64::INFINITY,
        length_error: f64::INFINITY,
        relative: f64::INFINITY,
    }
}

/// The least number of cells, not below `least`, whose transforms are fast: without prime factors
/// above 5, and even where a mirror plane halves them.
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

// Where asperities touch, before anything is refined.

impl Search<'_> {
    /// The contact on cells of the size of what the surface consists of, as far as there are not
    /// too many, in a window outside of which nothing touches.
    fn scouted(&self, spacing: [f64; 2]) -> Result<WindowContact, CheckUnavailable> {
        let modulus = 1.0 / self.surface.compliance;
        let mut window = Window::first(self.problem, self.gap, modulus, FEWEST as usize)
            .ok_or(CheckUnavailable::NotSettled)?;
        let mut most = FIRST;
        for _ in 0..MOST_WINDOWS {
            let found = self.solved(of_size(window, spacing, most), None)?;
            if let Some(next) = found.window.fitted(found.touched()) {
                window = next;
            } else if most < SCOUTED {
                most = SCOUTED;
            } else if let Some(wider) = self.touched_around(&found)? {
                window = wider;
            } else {
                return Ok(found);
            }
        }
        Err(CheckUnavailable::NotSettled)
    }

    /// The window with what touches around a contact in it; `None` where nothing does.
    fn touched_around(&self, found: &WindowContact) -> Result<Option<Window>, CheckUnavailable> {
        let (wide, first) = found.window.surroundings();
        let plane = Plane::new(self.problem, self.gap, &wide);
        let mut pressure = vec![0.0; plane.gap.len()];
        for (j, row) in found
            .pressed
            .pressure
            .chunks_exact(found.plane.width)
            .enumerate()
        {
            let start = (first[1] + j) * plane.width + first[0];
            pressure[start..start + row.len()].copy_from_slice(row);
        }
        let mut sunk = vec![0.0; pressure.len()];
        Operator::new(&wide, self.surface)?.apply(&pressure, &mut sunk);
        let least = DEEP * found.approach();
        let touches = |cell: usize| {
            let closing = plane.closing(cell, &found.pressed.motion);
            pressure[cell] == 0.0 && closing - plane.gap[cell] - sunk[cell] > least
        };
        let mut wider = found.window;
        for cell in (0..sunk.len()).filter(|&cell| touches(cell)) {
            let place = [cell % plane.width, cell / plane.width];
            wider = wider.with_place([0, 1].map(|axis| wide.centre(axis, place[axis])));
        }
        let (place, depth) = found.elsewhere(self.gap, self.surface.compliance);
        if depth > least {
            wider = wider.with_place(place);
        }
        Ok((!found.window.contains(&wider)).then_some(wider))
    }
}

/// A window with cells of this size, or of such a shape where that would be more than `most`.
fn of_size(window: Window, size: [f64; 2], most: f64) -> Window {
    let cells = |coarser: f64| {
        [0, 1].map(|axis| {
            let whole = window.high[axis] - window.low[axis];
            (whole / (coarser * size[axis])).max(FEWEST)
        })
    };
    // Where one axis has its fewest cells the other is coarsened alone.
    let mut coarser = 1.0;
    while cells(coarser).iter().product::<f64>() > most {
        coarser *= 1.25;
    }
    let cells = [0, 1].map(|axis| fast(cells(coarser)[axis] as usize, window.mirrored[axis]));
    window.with_cells(cells)
}

// What the pressures of a contact say.

/// A contact on all cells of its window, mirror planes unfolded.
struct Read {
    x: Vec<f64>,
    y: Vec<f64>,
    pressure: Vec<f64>,
    /// Of each cell [N].
    force: Vec<f64>,
    figures: Figures,
}

impl WindowContact {
    fn read(&self) -> Read {
        let [x, y] = [0, 1].map(|axis| self.nodes(axis));
        let [dx, dy] = self.window.size();
        let pressure = self.unfolded(&self.pressed.pressure);
        let force: Vec<f64> = pressure.iter().map(|p| p * dx * dy).collect();
        let lumped = [vec![dx; x.len()], vec![dy; y.len()]];
        let field = PressureField {
            x: &x,
            y: &y,
            force: &force,
            gap: None,
            lumped: [&lumped[0], &lumped[1]],
            symmetry: [false; 2],
            hardness: self.plane.hardness,
        };
        let mut figures = field.figures(&pressure);
        // Cells in contact are too many, as a rim has it in part of the outermost; ends of short
        // chords by shape and load lie too far inside. The truth is between them.
        let counted = force.iter().filter(|f| **f > 0.0).count() as f64 * dx * dy;
        figures.off[0] = (0.5 * (counted - figures.area).abs()).max(figures.off[0]);
        figures.area = 0.5 * (counted + figures.area);
        Read {
            x,
            y,
            pressure,
            force,
            figures,
        }
    }

    /// Solved cells in contact.
    fn touching(&self) -> usize {
        self.pressed.pressure.iter().filter(|p| **p > 0.0).count()
    }

    /// Half the mean size of an asperity's contact along x and y [m]: the half axis of an ellipse
    /// whose chords have the mean length of the stretches in contact.
    fn half_asperity(&self) -> [f64; 2] {
        let [nx, ny] = self.window.cells;
        let touches: Vec<bool> = self
            .unfolded(&self.pressed.pressure)
            .iter()
            .map(|p| *p > 0.0)
            .collect();
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
        let lowest = match plane.balance.is_empty() {
            true => 0.0,
            false => plane.gap.iter().copied().fold(f64::INFINITY, f64::min),
        };
        let cells = self
            .pressed
            .pressure
            .iter()
            .zip(&plane.gap)
            .zip(&self.pressed.sunk);
        let pressed = cells.filter(|((p, _), _)| **p > 0.0);
        let sum: f64 = pressed.map(|((p, g), u)| p * (g - lowest + 0.5 * u)).sum();
        let [dx, dy] = self.window.size();
        self.window.copies() * dx * dy * sum
    }

    /// Largest relative violation of the contact conditions and of the load's balance.
    fn violation(&self) -> f64 {
        let (plane, pressed) = (&self.plane, &self.pressed);
        let violated = |c: usize| match pressed.pressure[c] {
            p if p >= plane.hardness => pressed.opening[c].max(0.0),
            p if p > 0.0 => pressed.opening[c].abs(),
            _ => (-pressed.opening[c]).max(0.0),
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
