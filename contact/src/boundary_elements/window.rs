//! The rectangle of the contact plane that is divided into cells.

use crate::bisection::{bisect, bisect_scales};
use crate::boundary_elements::operator::Layer;
use crate::problem::gap::Gap;
use crate::{Foundation, Load, Problem};

/// How far along x contact is searched under a hull without ends [m].
const REACH: f64 = 2.0;
/// Samples of the gap along x, each way and each manner.
const SAMPLES: usize = 300;
/// Halvings of a depth or a width in logarithms, for a first window: to a thousandth.
const HALVINGS: usize = 16;
/// A first window's size over the patch that is guessed.
const AROUND: f64 = 1.5;
/// Growth of a window that contact reaches the border of.
const GROWTH: f64 = 1.6;
/// Least part of a window along an axis that contact is to fill.
const FILLED: f64 = 0.7;
/// Open cells around the contact in a regenerated window.
const MARGIN: f64 = 1.0;

/// A rectangle around the contact, in even cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Least x and y [m].
    pub low: [f64; 2],
    /// Largest x and y [m].
    pub high: [f64; 2],
    /// Cells along x and y, those across a mirror plane included.
    pub cells: [usize; 2],
    /// Whether x = 0 and y = 0 are mirror planes, in the middle of the window.
    pub mirrored: [bool; 2],
    /// Least gap on the line along x through the line of action [m].
    pub lowest: f64,
    /// The hull's ends: least and largest x, least and largest y [m].
    extent: [f64; 4],
}

impl Window {
    /// Around the part of the hull that a cut removes which is so deep (`depth` in E* depth (length
    /// width)^(1/2)) that it bears the load; `None` where no hull is above the line of action.
    pub fn first(problem: &Problem, gap: &Gap, modulus: f64, cells: usize) -> Option<Self> {
        let extent = problem.runner.underside.extent();
        let line = Line::new(gap, extent)?;
        let cut = match problem.load {
            Load::Approach { approach, .. } => line.cut(gap, approach),
            Load::Force { fz, .. } => {
                let [_, high] = bisect([1e-12f64.ln(), 1.0f64.ln()], HALVINGS, |middle| {
                    let [from, to, right, left] = line.cut(gap, middle.exp());
                    modulus * middle.exp() * ((to - from) * (left - right)).sqrt() < fz
                });
                line.cut(gap, high.exp())
            }
        };
        let window = Window {
            low: [cut[0], cut[2]],
            high: [cut[1], cut[3]],
            cells: [cells; 2],
            mirrored: gap.symmetry(),
            lowest: line.lowest,
            extent,
        };
        Some(window.scaled(AROUND))
    }

    /// So many cells between these ends `[x_min, y_min, x_max, y_max]`.
    #[cfg(test)]
    pub fn of_cells(ends: [f64; 4], cells: [usize; 2], mirrored: [bool; 2]) -> Self {
        Window {
            low: [ends[0], ends[1]],
            high: [ends[2], ends[3]],
            cells,
            mirrored,
            lowest: 0.0,
            extent: [
                f64::NEG_INFINITY,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::INFINITY,
            ],
        }
    }

    /// With other cells.
    pub fn with_cells(self, cells: [usize; 2]) -> Self {
        Window { cells, ..self }
    }

    /// Size of a cell along x and y [m].
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.high[axis] - self.low[axis]) / self.cells[axis] as f64)
    }

    /// Cells that are solved for along x and y.
    pub fn solved(&self) -> [usize; 2] {
        [0, 1].map(|axis| {
            if self.mirrored[axis] {
                self.cells[axis] / 2
            } else {
                self.cells[axis]
            }
        })
    }

    /// Number of cells that are solved for.
    pub fn count(&self) -> usize {
        self.solved().iter().product()
    }

    /// Number of cells with the pressure of a solved one.
    pub fn copies(&self) -> f64 {
        self.mirrored
            .map(|m| if m { 2.0 } else { 1.0 })
            .iter()
            .product()
    }

    /// Where the solved cells of an axis begin [m].
    fn origin(&self, axis: usize) -> f64 {
        if self.mirrored[axis] {
            0.0
        } else {
            self.low[axis]
        }
    }

    /// Centre of a solved cell along an axis [m].
    pub fn centre(&self, axis: usize, cell: usize) -> f64 {
        self.origin(axis) + (cell as f64 + 0.5) * self.size()[axis]
    }

    /// Centre of a solved cell, by its number with x fastest [m].
    pub fn place(&self, cell: usize) -> [f64; 2] {
        let width = self.solved()[0];
        [self.centre(0, cell % width), self.centre(1, cell / width)]
    }

    /// The solved cell that mirror planes make a cell of, along an axis.
    pub fn solved_cell(&self, axis: usize, cell: usize) -> usize {
        match self.cells[axis] / 2 {
            half if self.mirrored[axis] && cell < half => half - 1 - cell,
            half if self.mirrored[axis] => cell - half,
            _ => cell,
        }
    }

    /// A place and its images by the mirror planes [m].
    pub fn images(&self, [x, y]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
        let signs = self
            .mirrored
            .map(|m| if m { &[1.0, -1.0][..] } else { &[1.0] });
        let along = signs[0].iter();
        along.flat_map(move |s| signs[1].iter().map(move |t| [s * x, t * y]))
    }

    /// The distance from a place to the farthest corner [m].
    pub fn farthest(&self, place: [f64; 2]) -> f64 {
        let [x, y] = [0, 1].map(|axis| {
            let [low, high] = [self.low[axis], self.high[axis]];
            (place[axis] - low).abs().max((place[axis] - high).abs())
        });
        x.hypot(y)
    }

    /// Whether a place is on its cells or half its size from them.
    pub fn holds(&self, place: [f64; 2]) -> bool {
        (0..2).all(|axis| {
            let [low, high] = [self.low[axis], self.high[axis]];
            let margin = 0.5 * (high - low);
            (low - margin..=high + margin).contains(&place[axis])
        })
    }

    /// Places along the hull, on the lines through this window's middle and sides, that are half
    /// its size and more away from it.
    pub fn outside(&self) -> impl Iterator<Item = [f64; 2]> {
        let middle = [0, 1].map(|axis| 0.5 * (self.low[axis] + self.high[axis]));
        let lines = [self.low[1], middle[1], self.high[1]];
        let around = self.high[0] - self.low[0];
        let [from, to] = [self.extent[0], self.extent[1]]
            .map(|end| (end - middle[0]).clamp(-REACH, REACH) + middle[0]);
        let along = (0..=2 * SAMPLES)
            .map(move |k| from + (to - from) * k as f64 / (2 * SAMPLES) as f64)
            .filter(move |x| (x - middle[0]).abs() > around);
        along.flat_map(move |x| lines.map(|y| [x, y]))
    }

    /// The window that fits contact from the first to the last cell of each axis; `None` where this
    /// one does.
    pub fn fitted(&self, contact: [[usize; 2]; 2]) -> Option<Self> {
        let mut next = *self;
        let mut changed = false;
        for (axis, [first, last]) in contact.into_iter().enumerate() {
            let solved = self.solved()[axis];
            let [least, most] = [self.extent[2 * axis], self.extent[2 * axis + 1]];
            let touches_low = !self.mirrored[axis] && first == 0 && self.low[axis] > least;
            let touches_high = last + 1 == solved && self.high[axis] < most;
            let whole = self.high[axis] - self.low[axis];
            if touches_low {
                next.low[axis] -= (GROWTH - 1.0) * whole;
            }
            if touches_high {
                next.high[axis] += (GROWTH - 1.0) * whole;
            }
            let filled = if self.mirrored[axis] {
                last + 1
            } else {
                last + 1 - first
            };
            if touches_low || touches_high {
                changed = true;
            } else if (filled as f64) < FILLED * solved as f64 {
                changed = true;
                [next.low[axis], next.high[axis]] = self.ends(axis, [first, last], MARGIN);
            }
            if self.mirrored[axis] {
                next.low[axis] = -next.high[axis];
            }
        }
        changed.then(|| next.clipped())
    }

    /// The window from the first to the last cell in contact of each axis, with so many cells
    /// around.
    pub fn around(&self, contact: [[usize; 2]; 2], margin: f64) -> Self {
        let mut next = *self;
        for (axis, cells) in contact.into_iter().enumerate() {
            [next.low[axis], next.high[axis]] = self.ends(axis, cells, margin);
        }
        next.clipped()
    }

    /// Ends along an axis of some solved cells and others around them [m].
    fn ends(&self, axis: usize, [first, last]: [usize; 2], margin: f64) -> [f64; 2] {
        let around = (0.5 + margin) * self.size()[axis];
        let high = self.centre(axis, last) + around;
        if self.mirrored[axis] {
            [-high, high]
        } else {
            [self.centre(axis, first) - around, high]
        }
    }

    /// Whether another window lies within this one.
    pub fn contains(&self, other: &Window) -> bool {
        let slack = 1e-9;
        (0..2).all(|axis| {
            let slack = slack * (self.high[axis] - self.low[axis]);
            self.low[axis] <= other.low[axis] + slack && other.high[axis] <= self.high[axis] + slack
        })
    }

    /// The smallest window that contains this one and a place.
    pub fn with_place(&self, place: [f64; 2]) -> Self {
        let mut next = *self;
        for (axis, at) in place.into_iter().enumerate() {
            let ends = if self.mirrored[axis] {
                [-at.abs(), at.abs()]
            } else {
                [at; 2]
            };
            next.low[axis] = next.low[axis].min(ends[0]);
            next.high[axis] = next.high[axis].max(ends[1]);
        }
        next
    }

    /// This window with cells of the same size around it, as many as half of its own on each side
    /// as far as there is a hull; and the first of its own solved cells there.
    pub fn surroundings(&self) -> (Self, [usize; 2]) {
        let mut wide = *self;
        let mut first = [0; 2];
        for (axis, first) in first.iter_mut().enumerate() {
            let size = self.size()[axis];
            let most = (self.cells[axis] / 2) as f64;
            let room = |reach: f64| (reach / size).floor().clamp(0.0, most);
            let mut below = room(self.low[axis] - self.extent[2 * axis]);
            let mut above = room(self.extent[2 * axis + 1] - self.high[axis]);
            if self.mirrored[axis] {
                below = below.min(above);
                above = below;
            } else {
                *first = below as usize;
            }
            wide.low[axis] -= below * size;
            wide.high[axis] += above * size;
            wide.cells[axis] += (below + above) as usize;
        }
        (wide, first)
    }

    /// The solved cell that holds a place.
    pub fn cell(&self, axis: usize, at: f64) -> Option<usize> {
        let place = (at - self.origin(axis)) / self.size()[axis];
        (place >= 0.0 && place < self.solved()[axis] as f64).then_some(place as usize)
    }

    fn scaled(self, by: f64) -> Self {
        let mut next = self;
        for axis in 0..2 {
            let middle = if self.mirrored[axis] {
                0.0
            } else {
                0.5 * (self.low[axis] + self.high[axis])
            };
            let half = if self.mirrored[axis] {
                self.high[axis].max(-self.low[axis])
            } else {
                0.5 * (self.high[axis] - self.low[axis])
            };
            next.low[axis] = middle - by * half;
            next.high[axis] = middle + by * half;
        }
        next.clipped()
    }

    fn clipped(mut self) -> Self {
        for axis in 0..2 {
            self.low[axis] = self.low[axis].max(self.extent[2 * axis]);
            self.high[axis] = self.high[axis].min(self.extent[2 * axis + 1]);
        }
        self
    }
}

/// The gap along x through the line of action.
struct Line {
    /// x and gap over the lowest one [m].
    places: Vec<[f64; 2]>,
    lowest: f64,
    deepest: f64,
    y: f64,
    /// Least and largest y of the hull.
    across: [f64; 2],
}

impl Line {
    fn new(gap: &Gap, extent: [f64; 4]) -> Option<Self> {
        let [x0, y] = gap.line_of_action;
        let end = |end: f64, from: f64| {
            if end.is_finite() {
                end
            } else {
                from + end.signum() * REACH
            }
        };
        let mut xs = vec![x0];
        for to in [end(extent[0], x0) - x0, end(extent[1], x0) - x0] {
            for i in 1..=SAMPLES {
                let t = i as f64 / SAMPLES as f64;
                xs.extend([x0 + to * t, x0 + to * t.powi(4)]);
            }
        }
        xs.sort_by(f64::total_cmp);
        let places: Vec<[f64; 2]> = xs
            .iter()
            .map(|&x| [x, gap.at(x, y)])
            .filter(|place| place[1].is_finite())
            .collect();
        let [deepest, lowest] = *places.iter().min_by(|a, b| a[1].total_cmp(&b[1]))?;
        Some(Line {
            places: places.iter().map(|[x, g]| [*x, g - lowest]).collect(),
            lowest,
            deepest,
            y,
            across: [end(extent[2], y), end(extent[3], y)],
        })
    }

    /// Ends along x and y of what lies within `depth` of the lowest place [m].
    fn cut(&self, gap: &Gap, depth: f64) -> [f64; 4] {
        let inside = |place: &[f64; 2]| place[1] < depth;
        let first = self.places.iter().position(inside).unwrap_or(0);
        let last = self.places.iter().rposition(inside).unwrap_or(0);
        let crossing = |within: usize, next: Option<usize>| {
            let [x, g] = self.places[within];
            match next.and_then(|k| self.places.get(k)) {
                Some([to, over]) if *over > g => x + (to - x) * (depth - g) / (over - g),
                _ => x,
            }
        };
        let from = crossing(first, first.checked_sub(1));
        let to = crossing(last, Some(last + 1));
        let below = |y: f64| gap.at(self.deepest, y) - self.lowest < depth;
        let [right, left] = self.across.map(|end| {
            if below(end) {
                return end;
            }
            let (far, sign) = ((end - self.y).abs(), (end - self.y).signum());
            let [_, high] = bisect_scales([1e-9f64.min(far), far], HALVINGS, |middle| {
                below(self.y + sign * middle)
            });
            self.y + sign * high
        });
        [from, to, right, left]
    }
}

// What is pressed, where that is a half-space or layers, and why a contact has no second answer.

/// Why the contact plane alone has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckUnavailable {
    /// A bounded elastic runner: its bending is no half-space's.
    #[error("the runner is elastic and has ends")]
    ElasticRunner,
    /// A layer of less than a twelfth of a cell's size.
    #[error("the ice is too thin for the contact's cells")]
    ThinLayer,
    /// A peak of pressure no wider than a few cells, as at the ends of a runner.
    #[error("the pressure's peak is narrower than the cells")]
    NarrowPeak,
    /// The hull lies in the ice outside the cells, too: a second patch, or an end that touches.
    #[error("the runner touches elsewhere too")]
    Elsewhere,
    /// Boundary elements gave the first answer: a contact of many asperities.
    #[error("boundary elements gave the first answer")]
    FirstAnswer,
    /// The patch or its set does not settle.
    #[error("the contact set does not settle")]
    NotSettled,
    /// The caller stopped the solve.
    #[error("stopped before the end")]
    Stopped,
}

/// The two bodies' surfaces as one that gives for both.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// 1 / E* of both as half-spaces [1/Pa].
    pub compliance: f64,
    /// The ice and its foundation, from the top down; empty for a half-space.
    pub layers: Vec<Layer>,
}

impl Surface {
    /// The surface that the problem states.
    pub fn of(problem: &Problem) -> Result<Self, CheckUnavailable> {
        let ice = &problem.ice;
        if let Some(elastic) = &problem.runner.elastic {
            let unbounded = problem.runner.underside.extent();
            if elastic.solid.is_some() || unbounded.iter().any(|end| end.is_finite()) {
                return Err(CheckUnavailable::ElasticRunner);
            }
        }
        let top = |thickness: f64| Layer {
            youngs_modulus: ice.youngs_modulus,
            poissons_ratio: ice.poissons_ratio,
            thickness,
        };
        let layers = match ice.foundation {
            Foundation::HalfSpace => Vec::new(),
            Foundation::RigidBed { thickness } => vec![top(thickness)],
            Foundation::ElasticBed { thickness, bed } => vec![
                top(thickness),
                Layer {
                    youngs_modulus: bed.youngs_modulus,
                    poissons_ratio: bed.poissons_ratio,
                    thickness: bed.thickness,
                },
            ],
        };
        Ok(Surface {
            compliance: problem.compliance(),
            layers,
        })
    }
}
