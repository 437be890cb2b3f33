//! The rectangle of the contact plane that is divided into cells.

use crate::bisection::{bisect, bisect_scales};
use crate::problem::gap::Gap;
use crate::symmetry::image_count;
use crate::{Bed, Foundation, Load, Problem};

/// Distance along x up to which contact is searched under an unbounded hull [m].
const REACH: f64 = 2.0;
/// Number of samples of the gap along x in each direction, for each of two spacings.
const SAMPLES: usize = 300;
/// Number of bisections of the logarithm of a depth or a width for a first window: to a thousandth.
const HALVINGS: usize = 16;
/// Ratio of the size of a first window to the guessed patch.
const AROUND: f64 = 1.5;
/// Growth factor of a window whose border is in contact.
const GROWTH: f64 = 1.6;
/// Smallest fraction of a window along an axis that must be in contact.
const MIN_FILLED: f64 = 0.7;
/// Number of open cells around the contact in a fitted window.
const MARGIN: f64 = 1.0;

/// Even cells along one axis of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellAxis {
    /// Start of the cells [m].
    pub low: f64,
    /// End of the cells [m].
    pub high: f64,
    /// Number of cells, including those across a mirror plane.
    pub cells: usize,
    /// Whether 0 is a mirror plane, in the middle of the cells.
    pub mirrored: bool,
    /// The hull's ends [m].
    extent: [f64; 2],
}

impl CellAxis {
    /// Length of all cells [m].
    pub fn length(&self) -> f64 {
        self.high - self.low
    }

    /// Size of a cell [m].
    pub fn size(&self) -> f64 {
        self.length() / self.cells as f64
    }

    /// Number of cells that are solved for.
    fn solved(&self) -> usize {
        self.cells - self.first_solved()
    }

    /// The first cell that is solved for; those before it are images.
    pub fn first_solved(&self) -> usize {
        if self.mirrored { self.cells / 2 } else { 0 }
    }

    /// Start of the solved cells [m].
    fn origin(&self) -> f64 {
        if self.mirrored { 0.0 } else { self.low }
    }

    /// Centre of a solved cell [m].
    pub fn centre(&self, cell: usize) -> f64 {
        self.origin() + (cell as f64 + 0.5) * self.size()
    }

    /// The solved cell of which a cell is an image, or the cell itself.
    pub fn solved_cell(&self, cell: usize) -> usize {
        match self.first_solved() {
            first if cell < first => first - 1 - cell,
            first => cell - first,
        }
    }

    /// The solved cell that contains a place.
    pub fn cell(&self, at: f64) -> Option<usize> {
        let place = (at - self.origin()) / self.size();
        (place >= 0.0 && place < self.solved() as f64).then_some(place as usize)
    }

    /// The axis with these ends, limited to the hull's.
    fn between(self, low: f64, high: f64) -> Self {
        CellAxis {
            low: low.max(self.extent[0]),
            high: high.min(self.extent[1]),
            ..self
        }
    }

    /// The axis from the first to the last of some solved cells, with `margin` cells on both sides.
    fn around(self, [first, last]: [usize; 2], margin: f64) -> Self {
        let around = (0.5 + margin) * self.size();
        let high = self.centre(last) + around;
        if self.mirrored {
            self.between(-high, high)
        } else {
            self.between(self.centre(first) - around, high)
        }
    }

    /// The axis that fits contact from the first to the last cell; `None` if this axis does.
    fn fitted(self, [first, last]: [usize; 2]) -> Option<Self> {
        let solved = self.solved();
        let touches_low = !self.mirrored && first == 0 && self.low > self.extent[0];
        let touches_high = last + 1 == solved && self.high < self.extent[1];
        if touches_low || touches_high {
            let growth = (GROWTH - 1.0) * self.length();
            let grown = |touches: bool| if touches { growth } else { 0.0 };
            let high = self.high + grown(touches_high);
            let low = if self.mirrored {
                -high
            } else {
                self.low - grown(touches_low)
            };
            return Some(self.between(low, high));
        }
        let start = if self.mirrored { 0 } else { first };
        let filled = (last + 1 - start) as f64;
        (filled < MIN_FILLED * solved as f64).then(|| self.around([first, last], MARGIN))
    }

    fn scaled(self, by: f64) -> Self {
        let (middle, half) = if self.mirrored {
            (0.0, self.high.max(-self.low))
        } else {
            (0.5 * (self.low + self.high), 0.5 * self.length())
        };
        self.between(middle - by * half, middle + by * half)
    }

    fn contains(&self, other: &CellAxis) -> bool {
        let slack = 1e-9 * self.length();
        self.low <= other.low + slack && other.high <= self.high + slack
    }

    /// The shortest axis that contains this one and a place.
    fn with_place(self, at: f64) -> Self {
        let [low, high] = if self.mirrored {
            [-at.abs(), at.abs()]
        } else {
            [at; 2]
        };
        CellAxis {
            low: self.low.min(low),
            high: self.high.max(high),
            ..self
        }
    }

    /// The axis extended at both ends by half as many cells of the same size, within the hull; and
    /// the index of this axis' first solved cell in it.
    fn surroundings(self) -> (Self, usize) {
        let size = self.size();
        let most = (self.cells / 2) as f64;
        let room = |reach: f64| (reach / size).floor().clamp(0.0, most);
        let mut below = room(self.low - self.extent[0]);
        let mut above = room(self.extent[1] - self.high);
        let mut first = below as usize;
        if self.mirrored {
            below = below.min(above);
            above = below;
            first = 0;
        }
        let wide = CellAxis {
            low: self.low - below * size,
            high: self.high + above * size,
            cells: self.cells + (below + above) as usize,
            ..self
        };
        (wide, first)
    }
}

/// A rectangle around the contact, in even cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Along x and y.
    pub axes: [CellAxis; 2],
    /// Smallest gap on the line along x through the line of action [m].
    pub lowest: f64,
}

impl Window {
    /// The window around the part of the hull below a cut whose depth d is such that the load is E*
    /// d (length width)^(1/2); `None` if no hull is above the line of action.
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
        let mirrored = gap.symmetry();
        let axes = [0, 1].map(|axis| {
            let around = CellAxis {
                low: cut[2 * axis],
                high: cut[2 * axis + 1],
                cells,
                mirrored: mirrored[axis],
                extent: [extent[2 * axis], extent[2 * axis + 1]],
            };
            around.scaled(AROUND)
        });
        Some(Window {
            axes,
            lowest: line.lowest,
        })
    }

    /// A window of `cells` between these ends `[x_min, y_min, x_max, y_max]`.
    #[cfg(test)]
    pub fn of_cells(ends: [f64; 4], cells: [usize; 2], mirrored: [bool; 2]) -> Self {
        let axes = [0, 1].map(|axis| CellAxis {
            low: ends[axis],
            high: ends[2 + axis],
            cells: cells[axis],
            mirrored: mirrored[axis],
            extent: [f64::NEG_INFINITY, f64::INFINITY],
        });
        Window { axes, lowest: 0.0 }
    }

    /// The window with these numbers of cells along x and y.
    pub fn with_cells(self, cells: [usize; 2]) -> Self {
        let axes = [0, 1].map(|axis| CellAxis {
            cells: cells[axis],
            ..self.axes[axis]
        });
        Window { axes, ..self }
    }

    /// Numbers of cells along x and y, including those across a mirror plane.
    pub fn cells(&self) -> [usize; 2] {
        self.axes.map(|axis| axis.cells)
    }

    /// Whether x = 0 and y = 0 are mirror planes.
    pub fn mirrored(&self) -> [bool; 2] {
        self.axes.map(|axis| axis.mirrored)
    }

    /// Size of a cell along x and y [m].
    pub fn size(&self) -> [f64; 2] {
        self.axes.map(|axis| axis.size())
    }

    /// Numbers of cells along x and y that are solved for.
    pub fn solved(&self) -> [usize; 2] {
        self.axes.map(|axis| axis.solved())
    }

    /// Number of cells that are solved for.
    pub fn count(&self) -> usize {
        self.solved().iter().product()
    }

    /// Number of cells with the pressure of a solved one.
    pub fn image_count(&self) -> f64 {
        image_count(self.mirrored())
    }

    /// Centre of a solved cell, by its number with x fastest [m].
    pub fn place(&self, cell: usize) -> [f64; 2] {
        let [x, y] = &self.axes;
        [x.centre(cell % x.solved()), y.centre(cell / x.solved())]
    }

    /// The distance from a place to the farthest corner [m].
    pub fn farthest(&self, place: [f64; 2]) -> f64 {
        let far = |axis: &CellAxis, at: f64| (at - axis.low).abs().max((at - axis.high).abs());
        far(&self.axes[0], place[0]).hypot(far(&self.axes[1], place[1]))
    }

    /// Whether a place is on the cells or at most half the window's size away from them.
    pub fn holds(&self, place: [f64; 2]) -> bool {
        self.axes.iter().zip(place).all(|(axis, at)| {
            let margin = 0.5 * axis.length();
            (axis.low - margin..=axis.high + margin).contains(&at)
        })
    }

    /// Places along the hull, on the lines through this window's middle and sides, that are half
    /// its size and more away from it.
    pub fn outside(&self) -> impl Iterator<Item = [f64; 2]> {
        let [x, y] = self.axes;
        let middle = [x, y].map(|axis| 0.5 * (axis.low + axis.high));
        let lines = [y.low, middle[1], y.high];
        let around = x.length();
        let [from, to] = x
            .extent
            .map(|end| (end - middle[0]).clamp(-REACH, REACH) + middle[0]);
        let along = (0..=2 * SAMPLES)
            .map(move |k| from + (to - from) * k as f64 / (2 * SAMPLES) as f64)
            .filter(move |x| (x - middle[0]).abs() > around);
        along.flat_map(move |x| lines.map(|y| [x, y]))
    }

    /// The window that fits contact from the first to the last cell of each axis; `None` if this
    /// window does.
    pub fn fitted(&self, contact: [[usize; 2]; 2]) -> Option<Self> {
        let fitted = [0, 1].map(|axis| self.axes[axis].fitted(contact[axis]));
        fitted.iter().any(Option::is_some).then(|| Window {
            axes: [0, 1].map(|axis| fitted[axis].unwrap_or(self.axes[axis])),
            ..*self
        })
    }

    /// The window from the first to the last cell in contact of each axis, with `margin` cells
    /// around.
    pub fn around(&self, contact: [[usize; 2]; 2], margin: f64) -> Self {
        Window {
            axes: [0, 1].map(|axis| self.axes[axis].around(contact[axis], margin)),
            ..*self
        }
    }

    /// Whether another window lies within this one.
    pub fn contains(&self, other: &Window) -> bool {
        (0..2).all(|axis| self.axes[axis].contains(&other.axes[axis]))
    }

    /// The smallest window that contains this one and a place.
    pub fn with_place(&self, place: [f64; 2]) -> Self {
        Window {
            axes: [0, 1].map(|axis| self.axes[axis].with_place(place[axis])),
            ..*self
        }
    }

    /// This window with cells of the same size around it, and the indices of its first solved cell
    /// there.
    pub fn surroundings(&self) -> (Self, [usize; 2]) {
        let [(x, first_x), (y, first_y)] = self.axes.map(CellAxis::surroundings);
        let wide = Window {
            axes: [x, y],
            ..*self
        };
        (wide, [first_x, first_y])
    }
}

/// The gap along x through the line of action.
struct Line {
    /// x and gap over the lowest one [m].
    places: Vec<[f64; 2]>,
    lowest: f64,
    deepest: f64,
    y: f64,
    /// Smallest and largest y of the hull.
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

    /// Ends along x and y of the part within `depth` of the lowest point [m].
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

// The surface of both bodies, a half-space or layers, and the contacts without it.

/// Reasons why boundary elements have no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckUnavailable {
    /// A bounded elastic runner: it does not deform like a half-space.
    #[error("the runner is elastic and has ends")]
    ElasticRunner,
    /// A layer thinner than a twelfth of a cell.
    #[error("the ice is too thin for the contact's cells")]
    ThinLayer,
    /// A peak of pressure no wider than a few cells, as at the ends of a runner.
    #[error("the pressure's peak is narrower than the cells")]
    NarrowPeak,
    /// There is contact outside the cells: a second patch, or an end of the hull.
    #[error("the runner touches elsewhere too")]
    Elsewhere,
    /// The solution itself is by boundary elements: a contact of many asperities.
    #[error("boundary elements gave the first answer")]
    FirstAnswer,
    /// The window or the contact set does not converge.
    #[error("the contact set does not settle")]
    NotSettled,
    /// The caller stopped the solve.
    #[error("stopped before the end")]
    Stopped,
}

/// Compliance of both bodies' surfaces together.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// 1 / E* of both as half-spaces [1/Pa].
    pub compliance: f64,
    /// The ice and its foundation, from the top down; empty for a half-space.
    pub layers: Vec<Bed>,
}

impl Surface {
    /// The surface that the problem states.
    pub fn of(problem: &Problem) -> Result<Self, CheckUnavailable> {
        let ice = &problem.ice;
        if let Some(elastic) = &problem.runner.elastic {
            let extent = problem.runner.underside.extent();
            if elastic.solid.is_some() || extent.iter().any(|end| end.is_finite()) {
                return Err(CheckUnavailable::ElasticRunner);
            }
        }
        let top = |thickness: f64| Bed {
            youngs_modulus: ice.youngs_modulus,
            poissons_ratio: ice.poissons_ratio,
            thickness,
        };
        let layers = match ice.foundation {
            Foundation::HalfSpace => Vec::new(),
            Foundation::RigidBed { thickness } => vec![top(thickness)],
            Foundation::ElasticBed { thickness, bed } => vec![top(thickness), bed],
        };
        Ok(Surface {
            compliance: problem.compliance(),
            layers,
        })
    }
}
