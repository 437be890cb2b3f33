//! Pressures on cells: sets of open, pressed and yielding cells, each solved by projected conjugate
//! gradients.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::boundary_elements::operator::Operator;
use crate::boundary_elements::window::{CheckUnavailable, Window};
use crate::problem::gap::Gap;
use crate::{Load, Options, Problem};

/// Where a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cell {
    Open,
    Pressed,
    /// At the hardness.
    Yielding,
}

/// Pressures on the cells of a plane.
#[derive(Clone, Debug)]
pub(super) struct PressureState {
    /// Pressures [Pa].
    pub pressure: Vec<f64>,
    /// Gap of the deformed surface, negative where the ice yields [m].
    pub opening: Vec<f64>,
    /// Displacement of the surface, downwards [m].
    pub sunk: Vec<f64>,
    /// The free motions, in the order of [`Plane::motions`].
    pub motion: Vec<f64>,
    /// Sets that were solved for.
    pub sets: usize,
    /// Steps of conjugate gradients on all of them.
    pub steps: usize,
}

/// When pressures are solved for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Precision {
    /// Largest root mean square of the gaps of pressed cells, over the approach.
    pub residual: f64,
    /// Part of the largest pressure and of the approach within which a cell stays where it is.
    pub slack: f64,
}

/// Sets that are tried.
const MOST_SETS: usize = 60;
/// Sets after which residuals are made smaller though cells change.
const PATIENCE: usize = 15;
/// Steps of one set's conjugate gradients.
const MOST_STEPS: usize = 400;
/// Residuals over the approach: of the first sets, and of a set that did not change over those
/// before.
const ROUGH: f64 = 1e-2;
const FINER: f64 = 0.03;
/// Part of the cells that the first set has, those of the least gaps.
const FIRST: f64 = 0.3;

/// Solves for pressures that balance the load, 0 where the gap is open and at most the hardness.
///
/// They make 1/2 p^T K p + g^T p least over 0 <= p <= hardness with N^T p as the load requires. On
/// a set, conjugate gradients keep the balance by projecting residuals; motions are what the
/// projection takes out (after I. A. Polonsky and L. M. Keer, Wear 231, 1999). Cells change where
/// their sign is wrong (primal-dual active set; M. Hintermueller, K. Ito and K. Kunisch, SIAM J.
/// Optim. 13, 2002).
pub(super) fn press(
    plane: &Plane,
    operator: &mut Operator,
    start: Option<Vec<f64>>,
    precision: Precision,
    options: &Options,
) -> Result<PressureState, CheckUnavailable> {
    let mut solve = Solve::new(plane, operator, start, options);
    let mut tolerance = ROUGH;
    for set in 0..MOST_SETS {
        // With rough residuals the sets may cycle.
        if set >= PATIENCE {
            tolerance = (tolerance * FINER).max(precision.residual);
        }
        solve.on_set(tolerance)?;
        let changed = solve.change_set(precision.slack);
        if !changed && tolerance <= precision.residual {
            return Ok(solve.finished());
        }
        if !changed {
            tolerance = (tolerance * FINER).max(precision.residual);
        }
    }
    Err(CheckUnavailable::NotSettled)
}

struct Solve<'a> {
    plane: &'a Plane,
    operator: &'a mut Operator,
    cells: Vec<Cell>,
    now: PressureState,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// With the flag that ends the solve.
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
            let first = sorted.get((FIRST * sorted.len() as f64) as usize);
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
            now: PressureState {
                pressure,
                opening: vec![0.0; count],
                sunk: vec![0.0; count],
                motion: Vec::new(),
                sets: 0,
                steps: 0,
            },
            direction: vec![0.0; count],
            product: vec![0.0; count],
            options,
        }
    }

    /// Pressures of the set as it is, to a residual over the approach.
    fn on_set(&mut self, tolerance: f64) -> Result<(), CheckUnavailable> {
        self.now.sets += 1;
        let count = self.cells.len();
        let pressed: Vec<usize> = (0..count)
            .filter(|&c| self.cells[c] == Cell::Pressed)
            .collect();
        let balance = Balance::new(self.plane, &pressed)?;
        for c in 0..count {
            match self.cells[c] {
                Cell::Open => self.now.pressure[c] = 0.0,
                Cell::Yielding => self.now.pressure[c] = self.plane.hardness,
                Cell::Pressed => {}
            }
        }
        balance.restore(self.plane, &pressed, &mut self.now.pressure);
        let mut moved = vec![0.0; count];
        self.operator.apply(&self.now.pressure, &mut moved);
        let moved = moved.iter().zip(&self.plane.gap);
        let mut residual: Vec<f64> = moved.map(|(u, g)| u + g).collect();
        self.direction.fill(0.0);
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            if self.options.stopped() {
                return Err(CheckUnavailable::Stopped);
            }
            self.now.motion = balance.take_out(self.plane, &pressed, &residual);
            self.plane
                .opened(&residual, &self.now.motion, &mut self.now.opening);
            let opening = &self.now.opening;
            // How deep the hull's lowest place goes: closing - gap = residual - gap - opening.
            let (mut square, mut depth) = (0.0, f64::MIN_POSITIVE);
            for &c in &pressed {
                square += opening[c] * opening[c];
                depth = f64::max(depth, residual[c] - self.plane.gap[c] - opening[c]);
            }
            if square.sqrt() <= tolerance * depth * (pressed.len() as f64).sqrt() {
                return Ok(());
            }
            let turn = square / before;
            before = square;
            for &c in &pressed {
                self.direction[c] = turn * self.direction[c] - opening[c];
            }
            self.now.steps += 1;
            self.operator.apply(&self.direction, &mut self.product);
            let along = pressed.iter().map(|&c| self.direction[c] * self.product[c]);
            let curvature: f64 = along.sum();
            if curvature.is_nan() || curvature <= 0.0 {
                return Err(CheckUnavailable::NotSettled);
            }
            let step = square / curvature;
            for &c in &pressed {
                self.now.pressure[c] += step * self.direction[c];
            }
            for (r, k) in residual.iter_mut().zip(&self.product) {
                *r += step * k;
            }
        }
        Err(CheckUnavailable::NotSettled)
    }

    /// The state with pressures within their bounds and the displacements that they make.
    fn finished(mut self) -> PressureState {
        let hardness = self.plane.hardness;
        let pressures = self.now.pressure.iter_mut();
        pressures.for_each(|p| *p = p.clamp(0.0, hardness));
        self.operator.apply(&self.now.pressure, &mut self.now.sunk);
        let sunk = self.now.sunk.iter().zip(&self.plane.gap);
        let residual: Vec<f64> = sunk.map(|(u, g)| u + g).collect();
        self.plane
            .opened(&residual, &self.now.motion, &mut self.now.opening);
        self.now
    }

    /// The pressure from which cells yield next: the hardness, but for half of the overloaded ones
    /// where these are most of the set, which would carry nothing without them [Pa].
    fn yields(&self) -> f64 {
        let hardness = self.plane.hardness;
        let pressed = || {
            let cells = self.cells.iter().zip(&self.now.pressure);
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

    /// Opens, closes and yields where signs are wrong; whether any cell was.
    fn change_set(&mut self, slack: f64) -> bool {
        let PressureState {
            pressure,
            opening,
            motion,
            ..
        } = &self.now;
        let top = pressure.iter().copied().fold(0.0, f64::max);
        let depth = (0..opening.len())
            .map(|c| self.plane.closing(c, motion) - self.plane.gap[c])
            .fold(0.0, f64::max);
        let yields = self.yields();
        let mut changed = false;
        for (c, cell) in self.cells.iter_mut().enumerate() {
            let next = match *cell {
                Cell::Pressed if pressure[c] < -slack * top => Cell::Open,
                Cell::Pressed if pressure[c] >= yields => Cell::Yielding,
                Cell::Open if opening[c] < -slack * depth => Cell::Pressed,
                Cell::Yielding if opening[c] > slack * depth => Cell::Pressed,
                same => same,
            };
            changed |= next != *cell;
            *cell = next;
        }
        changed
    }
}

/// The projection that keeps pressures of a set in balance.
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

    /// The motions that a residual on the set contains.
    fn take_out(&self, plane: &Plane, pressed: &[usize], residual: &[f64]) -> Vec<f64> {
        let sum = |row: &Vec<f64>| -> f64 { pressed.iter().map(|&c| row[c] * residual[c]).sum() };
        let sums = plane.motions.iter().map(sum);
        let sums = DVector::from_iterator(plane.motions.len(), sums);
        (&self.inverse * sums).as_slice().to_vec()
    }

    /// Changes pressures of the set by as little as balances the load.
    fn restore(&self, plane: &Plane, pressed: &[usize], pressure: &mut [f64]) {
        let motions = plane.motions.iter().zip(&plane.balance);
        let short = motions.map(|(row, required)| {
            let terms = row.iter().zip(pressure.iter()).map(|(n, p)| n * p);
            required - terms.sum::<f64>()
        });
        let short = DVector::from_iterator(plane.motions.len(), short);
        let by = &self.inverse * short;
        for &c in pressed {
            pressure[c] += plane.closing(c, by.as_slice());
        }
    }
}

// A contact problem on the cells of a window.

/// What presses, cell by cell (x fastest).
pub(super) struct Plane {
    /// Cells along x that are solved for.
    pub width: usize,
    /// Undeformed gap at the centres less the motion that is fixed; infinite where there is no hull
    /// [m].
    pub gap: Vec<f64>,
    /// How the motions that follow from balance close the gap, one list a motion.
    pub motions: Vec<Vec<f64>>,
    /// Which motions these are: approach, and tilts by x and by y.
    free: Vec<usize>,
    /// The motion that is fixed [m].
    fixed: f64,
    /// What the cells' pressures times those rows sum to [Pa], [Pa m].
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
            Load::Force { fz, .. } => balance[0] = fz / (window.copies() * dx * dy),
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

    /// `opening` = `residual` less the closing by motions, cell by cell [m].
    pub fn opened(&self, residual: &[f64], motion: &[f64], opening: &mut [f64]) {
        opening.copy_from_slice(residual);
        for (row, q) in self.motions.iter().zip(motion) {
            for (opening, n) in opening.iter_mut().zip(row) {
                *opening -= n * q;
            }
        }
    }

    /// Approach, pitch and roll of the free motions; what is fixed is part of the gap.
    pub fn motion(&self, motion: &[f64]) -> [f64; 3] {
        let mut all = [0.0; 3];
        self.free.iter().zip(motion).for_each(|(&a, q)| all[a] = *q);
        all
    }

    /// How much motions close the gap of a cell [m].
    pub fn closing(&self, cell: usize, motion: &[f64]) -> f64 {
        let terms = self.motions.iter().zip(motion);
        terms.map(|(row, q)| row[cell] * q).sum()
    }

    /// How deep the hull lies below the undeformed ice anywhere on the plane [m].
    pub fn depth(&self, gap: &Gap, motion: &[f64], [x, y]: [f64; 2]) -> f64 {
        let row = gap.motion_row(x, y);
        let closed: f64 = self.free.iter().zip(motion).map(|(a, q)| row[*a] * q).sum();
        closed + self.fixed - gap.at(x, y)
    }
}
