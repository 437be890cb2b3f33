//! Pressures on cells by a primal-dual active set: each set of open, pressed and yielding cells is
//! solved by projected conjugate gradients.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::boundary_elements::operator::Operator;
use crate::boundary_elements::window::{CheckUnavailable, Window};
use crate::problem::gap::Gap;
use crate::{Load, Options, Problem};

/// State of a cell in the active set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cell {
    /// Pressure 0.
    Open,
    /// Gap 0.
    Pressed,
    /// Pressure at the hardness.
    Yielding,
}

/// Pressures on the cells of a plane.
#[derive(Clone, Debug)]
pub(super) struct PressureState {
    /// Pressures [Pa].
    pub pressure: Vec<f64>,
    /// Gap of the deformed surface, negative where the ice yield_threshold [m].
    pub deformed_gap: Vec<f64>,
    /// Displacement of the surface, downwards [m].
    pub displacement: Vec<f64>,
    /// The free motions, in the order of [`Plane::motions`].
    pub motion: Vec<f64>,
    /// Number of sets that were solved.
    pub sets: usize,
    /// Total number of conjugate-gradient steps.
    pub steps: usize,
}

/// Convergence criteria.
#[derive(Clone, Copy, Debug)]
pub(super) struct Criteria {
    /// Largest root mean square of the gaps of pressed cells, relative to the approach.
    pub residual: f64,
    /// Fraction of the largest pressure and of the approach up to which a wrong sign does not
    /// change a cell's state.
    pub slack: f64,
}

/// Largest number of sets.
const MAX_SETS: usize = 60;
/// Number of sets after which the residual tolerance is tightened although the set changes.
const FREE_SETS: usize = 15;
/// Largest number of conjugate-gradient steps on one set.
const MAX_STEPS: usize = 400;
/// Residual tolerance of the first sets, relative to the approach.
const INITIAL_RTOL: f64 = 1e-2;
/// Factor by which the residual tolerance is tightened when the set did not change.
const RTOL_FACTOR: f64 = 0.03;
/// Fraction of the cells that are in the first set: the cells with the smallest gaps.
const INITIAL_FRACTION: f64 = 0.3;

/// Solves for pressures that balance the load, 0 where the gap is open and at most the hardness.
///
/// They minimise 1/2 p^T K p + g^T p over 0 <= p <= hardness with N^T p as the load requires. On a
/// set, conjugate gradients keep the balance by projecting residuals; the rigid motion is the part
/// that the projection removes (after I. A. Polonsky and L. M. Keer, Wear 231, 1999). Cells with a
/// wrong sign of pressure or gap change their state (primal-dual active set; M. Hintermueller, K.
/// Ito and K. Kunisch, SIAM J. Optim. 13, 2002).
pub(super) fn press(
    plane: &Plane,
    operator: &mut Operator,
    start: Option<Vec<f64>>,
    precision: Criteria,
    options: &Options,
) -> Result<PressureState, CheckUnavailable> {
    let mut solve = Solve::new(plane, operator, start, options);
    let mut tolerance = INITIAL_RTOL;
    for set in 0..MAX_SETS {
        // With large residuals the sets may cycle.
        if set >= FREE_SETS {
            tolerance = (tolerance * RTOL_FACTOR).max(precision.residual);
        }
        solve.solve_set(tolerance)?;
        let changed = solve.change_set(precision.slack);
        if !changed && tolerance <= precision.residual {
            return Ok(solve.finished());
        }
        if !changed {
            tolerance = (tolerance * RTOL_FACTOR).max(precision.residual);
        }
    }
    Err(CheckUnavailable::NotSettled)
}

struct Solve<'a> {
    plane: &'a Plane,
    operator: &'a mut Operator,
    cells: Vec<Cell>,
    state: PressureState,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// Holds the flag that stops the solve.
    options: &'a Options,
}

impl<'a> Solve<'a> {
    fn new(
        plane: &'a Plane,
        operator: &'a mut Operator,
        start: Option<Vec<f64>>,
        options: &'a Options,
    ) -> Self {
        let count = plane.gap.len();
        let pressure = start.unwrap_or_else(|| {
            let finite = plane.gap.iter().copied().filter(|g| g.is_finite());
            let mut sorted: Vec<f64> = finite.collect();
            sorted.sort_by(f64::total_cmp);
            let first = sorted.get((INITIAL_FRACTION * sorted.len() as f64) as usize);
            let deepest = first.copied().unwrap_or(0.0);
            let level = plane.gap.iter().map(|g| (deepest - g).max(0.0));
            level.collect()
        });
        let state = |p: &f64| {
            if *p <= 0.0 { Cell::Open } else { Cell::Pressed }
        };
        Solve {
            cells: pressure.iter().map(state).collect(),
            plane,
            operator,
            state: PressureState {
                pressure,
                deformed_gap: vec![0.0; count],
                displacement: vec![0.0; count],
                motion: Vec::new(),
                sets: 0,
                steps: 0,
            },
            direction: vec![0.0; count],
            product: vec![0.0; count],
            options,
        }
    }

    /// Solves for the pressures of the present set, to a residual relative to the approach.
    fn solve_set(&mut self, tolerance: f64) -> Result<(), CheckUnavailable> {
        self.state.sets += 1;
        let count = self.cells.len();
        let pressed: Vec<usize> = (0..count)
            .filter(|&c| self.cells[c] == Cell::Pressed)
            .collect();
        let balance = Balance::new(self.plane, &pressed)?;
        for c in 0..count {
            match self.cells[c] {
                Cell::Open => self.state.pressure[c] = 0.0,
                Cell::Yielding => self.state.pressure[c] = self.plane.hardness,
                Cell::Pressed => {}
            }
        }
        balance.restore_balance(self.plane, &pressed, &mut self.state.pressure);
        let mut displacement = vec![0.0; count];
        self.operator.apply(&self.state.pressure, &mut displacement);
        let pairs = displacement.iter().zip(&self.plane.gap);
        let mut residual: Vec<f64> = pairs.map(|(u, g)| u + g).collect();
        self.direction.fill(0.0);
        // Infinite at first, so that beta is 0.
        let mut previous_square = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            if self.options.stopped() {
                return Err(CheckUnavailable::Stopped);
            }
            self.state.motion = balance.fit_motion(self.plane, &pressed, &residual);
            self.plane
                .subtract_motion(&residual, &self.state.motion, &mut self.state.deformed_gap);
            let deformed_gap = &self.state.deformed_gap;
            // Depth of the hull's lowest place: closing - gap = residual - gap - deformed gap.
            let (mut square, mut depth) = (0.0, f64::MIN_POSITIVE);
            for &c in &pressed {
                square += deformed_gap[c] * deformed_gap[c];
                depth = f64::max(depth, residual[c] - self.plane.gap[c] - deformed_gap[c]);
            }
            if square.sqrt() <= tolerance * depth * (pressed.len() as f64).sqrt() {
                return Ok(());
            }
            let beta = square / previous_square;
            previous_square = square;
            for &c in &pressed {
                self.direction[c] = beta * self.direction[c] - deformed_gap[c];
            }
            self.state.steps += 1;
            self.operator.apply(&self.direction, &mut self.product);
            let terms = pressed.iter().map(|&c| self.direction[c] * self.product[c]);
            let curvature: f64 = terms.sum();
            if curvature.is_nan() || curvature <= 0.0 {
                return Err(CheckUnavailable::NotSettled);
            }
            let alpha = square / curvature;
            for &c in &pressed {
                self.state.pressure[c] += alpha * self.direction[c];
            }
            for (r, k) in residual.iter_mut().zip(&self.product) {
                *r += alpha * k;
            }
        }
        Err(CheckUnavailable::NotSettled)
    }

    /// The final state: pressures clamped to their bounds, with their displacements and gaps.
    fn finished(mut self) -> PressureState {
        let hardness = self.plane.hardness;
        let pressures = self.state.pressure.iter_mut();
        pressures.for_each(|p| *p = p.clamp(0.0, hardness));
        self.operator
            .apply(&self.state.pressure, &mut self.state.displacement);
        let displacement = self.state.displacement.iter().zip(&self.plane.gap);
        let residual: Vec<f64> = displacement.map(|(u, g)| u + g).collect();
        self.plane
            .subtract_motion(&residual, &self.state.motion, &mut self.state.deformed_gap);
        self.state
    }

    /// Pressure from which pressed cells become yielding [Pa]: any above the hardness.
    ///
    /// If more than half of the pressed cells exceed the hardness, only the more loaded half of
    /// these yields: the remaining set could otherwise not carry the load.
    fn yield_threshold(&self) -> f64 {
        let hardness = self.plane.hardness;
        let pressed = || {
            let cells = self.cells.iter().zip(&self.state.pressure);
            cells.filter(|(cell, _)| **cell == Cell::Pressed)
        };
        let over = pressed().map(|(_, p)| *p).filter(|p| *p > hardness);
        let mut over: Vec<f64> = over.collect();
        if 2 * over.len() <= pressed().count() {
            return hardness.next_up();
        }
        over.sort_by(f64::total_cmp);
        over[over.len() / 2]
    }

    /// Changes the state of cells with a wrong sign; returns whether any changed.
    fn change_set(&mut self, slack: f64) -> bool {
        let PressureState {
            pressure,
            deformed_gap,
            motion,
            ..
        } = &self.state;
        let top = pressure.iter().copied().fold(0.0, f64::max);
        let depth = (0..deformed_gap.len())
            .map(|c| self.plane.closing(c, motion) - self.plane.gap[c])
            .fold(0.0, f64::max);
        let threshold = self.yield_threshold();
        let mut changed = false;
        for (c, cell) in self.cells.iter_mut().enumerate() {
            let next = match *cell {
                Cell::Pressed if pressure[c] < -slack * top => Cell::Open,
                Cell::Pressed if pressure[c] >= threshold => Cell::Yielding,
                Cell::Open if deformed_gap[c] < -slack * depth => Cell::Pressed,
                Cell::Yielding if deformed_gap[c] > slack * depth => Cell::Pressed,
                same => same,
            };
            changed |= next != *cell;
            *cell = next;
        }
        changed
    }
}

/// Orthogonal projection of pressures of a set onto the load balance.
struct Balance {
    /// Inverse of N^T N on the set.
    inverse: DMatrix<f64>,
}

impl Balance {
    fn new(plane: &Plane, pressed: &[usize]) -> Result<Self, CheckUnavailable> {
        let count = plane.motions.len();
        let sum = |a: usize, b: usize| -> f64 {
            let (a, b) = (&plane.motions[a], &plane.motions[b]);
            pressed.iter().map(|&c| a[c] * b[c]).sum()
        };
        let gram = DMatrix::from_fn(count, count, sum);
        let inverse = gram
            .try_inverse()
            .filter(|i| i.iter().all(|v| v.is_finite()));
        match inverse {
            Some(inverse) if !pressed.is_empty() => Ok(Balance { inverse }),
            _ => Err(CheckUnavailable::NotSettled),
        }
    }

    /// The rigid motion that fits a residual on the set in least squares.
    fn fit_motion(&self, plane: &Plane, pressed: &[usize], residual: &[f64]) -> Vec<f64> {
        let sum = |row: &Vec<f64>| -> f64 { pressed.iter().map(|&c| row[c] * residual[c]).sum() };
        let sums = plane.motions.iter().map(sum);
        let sums = DVector::from_iterator(plane.motions.len(), sums);
        (&self.inverse * sums).as_slice().to_vec()
    }

    /// Changes pressures of the set by the smallest amount (2-norm) that balances the load.
    fn restore_balance(&self, plane: &Plane, pressed: &[usize], pressure: &mut [f64]) {
        let motions = plane.motions.iter().zip(&plane.balance);
        let imbalance = motions.map(|(row, required)| {
            let terms = row.iter().zip(pressure.iter()).map(|(n, p)| n * p);
            required - terms.sum::<f64>()
        });
        let imbalance = DVector::from_iterator(plane.motions.len(), imbalance);
        let multipliers = &self.inverse * imbalance;
        for &c in pressed {
            pressure[c] += plane.closing(c, multipliers.as_slice());
        }
    }
}

// A contact problem on the cells of a window.

/// The discretised contact problem, cell by cell (x fastest).
pub(super) struct Plane {
    /// Number of solved cells along x.
    pub width: usize,
    /// Undeformed gap at the centres less the prescribed motion; infinite where there is no hull
    /// [m].
    pub gap: Vec<f64>,
    /// N: closing of the gap by each free motion, one list of cells per motion.
    pub motions: Vec<Vec<f64>>,
    /// Indices of the free motions: approach, and tilts by x and by y.
    free: Vec<usize>,
    /// The prescribed approach [m].
    fixed: f64,
    /// Right-hand side of N^T p = balance: force and moments divided by the area of a cell [Pa],
    /// [Pa m].
    pub balance: Vec<f64>,
    /// Largest pressure [Pa].
    pub hardness: f64,
}

impl Plane {
    /// The problem's gap and load on a window's cells.
    pub fn new(problem: &Problem, gap: &Gap, window: &Window) -> Self {
        let [nx, ny] = window.solved();
        let places: Vec<[f64; 2]> = (0..nx * ny).map(|cell| window.place(cell)).collect();
        let mut gaps: Vec<f64> = places.par_iter().map(|&[x, y]| gap.at(x, y)).collect();
        let free: Vec<usize> = (0..3)
            .filter(|&a| gap.free_motion[a] && (a == 0 || !window.axes[a - 1].mirrored))
            .collect();
        let rows = |a: usize| places.iter().map(move |&[x, y]| gap.motion_row(x, y)[a]);
        let motions: Vec<Vec<f64>> = free.iter().map(|&a| rows(a).collect()).collect();
        let [dx, dy] = window.size();
        let (mut balance, mut fixed) = (vec![0.0; free.len()], 0.0);
        match problem.load {
            Load::Force { fz, .. } => balance[0] = fz / (window.image_count() * dx * dy),
            Load::Approach { approach, .. } => {
                let lowest = gaps.iter().copied().fold(window.lowest, f64::min);
                fixed = approach + lowest;
                gaps.iter_mut().for_each(|g| *g -= fixed);
            }
        }
        Plane {
            width: nx,
            gap: gaps,
            motions,
            free,
            fixed,
            balance,
            hardness: problem.ice.hardness.unwrap_or(f64::INFINITY),
        }
    }

    /// `deformed_gap` = `residual` - N `motion` [m].
    pub fn subtract_motion(&self, residual: &[f64], motion: &[f64], deformed_gap: &mut [f64]) {
        deformed_gap.copy_from_slice(residual);
        for (row, q) in self.motions.iter().zip(motion) {
            for (deformed_gap, n) in deformed_gap.iter_mut().zip(row) {
                *deformed_gap -= n * q;
            }
        }
    }

    /// Approach, pitch and roll from the free motions; the prescribed motion is part of the gap.
    pub fn motion(&self, motion: &[f64]) -> [f64; 3] {
        let mut all = [0.0; 3];
        self.free.iter().zip(motion).for_each(|(&a, q)| all[a] = *q);
        all
    }

    /// Closing of the gap of a cell by motions [m].
    pub fn closing(&self, cell: usize, motion: &[f64]) -> f64 {
        let terms = self.motions.iter().zip(motion);
        terms.map(|(row, q)| row[cell] * q).sum()
    }

    /// Depth of the hull below the undeformed ice at a place (x, y) [m].
    pub fn depth(&self, gap: &Gap, motion: &[f64], [x, y]: [f64; 2]) -> f64 {
        let row = gap.motion_row(x, y);
        let closed: f64 = self.free.iter().zip(motion).map(|(a, q)| row[*a] * q).sum();
        closed + self.fixed - gap.at(x, y)
    }
}
