//! A contact problem on the cells of a window.

use crate::problem::gap::Gap;
use crate::{Load, Problem};

use super::window::Window;

/// What presses, cell by cell (x fastest).
pub(super) struct Plane {
    /// Cells along x that are solved for.
    pub width: usize,
    /// Undeformed gap at the centres less the motion that is held; infinite where there is no hull [m].
    pub gap: Vec<f64>,
    /// How the motions that follow from balance close the gap, one list a motion.
    pub motions: Vec<Vec<f64>>,
    /// Which motions these are: approach, and tilts by x and by y.
    free: Vec<usize>,
    /// The motion that is held [m].
    held: f64,
    /// What the cells' pressures times those rows sum to [Pa], [Pa m].
    pub balance: Vec<f64>,
    /// Largest pressure [Pa].
    pub hardness: f64,
}

impl Plane {
    /// The problem's gap and load on a window's cells.
    pub fn new(problem: &Problem, gap: &Gap, window: &Window) -> Self {
        let [nx, ny] = window.solved();
        let places: Vec<[f64; 2]> = (0..ny)
            .flat_map(|j| (0..nx).map(move |i| [i, j]))
            .map(|[i, j]| [window.centre(0, i), window.centre(1, j)])
            .collect();
        let mut gaps: Vec<f64> = places.iter().map(|&[x, y]| gap.at(x, y)).collect();
        let free: Vec<usize> = (0..3)
            .filter(|&a| gap.free_motion[a] && (a == 0 || !window.mirrored[a - 1]))
            .collect();
        let motions: Vec<Vec<f64>> = free
            .iter()
            .map(|&a| {
                places
                    .iter()
                    .map(|&[x, y]| gap.motion_row(x, y)[a])
                    .collect()
            })
            .collect();
        let [dx, dy] = window.size();
        let copies: f64 = window
            .mirrored
            .map(|m| if m { 2.0 } else { 1.0 })
            .iter()
            .product();
        let (mut balance, mut held) = (vec![0.0; free.len()], 0.0);
        match problem.load {
            Load::Force { fz, .. } => balance[0] = fz / (copies * dx * dy),
            Load::Approach { approach, .. } => {
                let lowest = gaps.iter().copied().fold(window.lowest, f64::min);
                held = approach + lowest;
                gaps.iter_mut().for_each(|g| *g -= held);
            }
        }
        Plane {
            width: nx,
            gap: gaps,
            motions,
            free,
            held,
            balance,
            hardness: problem.ice.hardness.unwrap_or(f64::INFINITY),
        }
    }

    /// `left` = `residual` less what motions close, cell by cell [m].
    pub fn opened(&self, residual: &[f64], motion: &[f64], left: &mut [f64]) {
        left.copy_from_slice(residual);
        for (row, q) in self.motions.iter().zip(motion) {
            for (left, n) in left.iter_mut().zip(row) {
                *left -= n * q;
            }
        }
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
        closed + self.held - gap.at(x, y)
    }
}
