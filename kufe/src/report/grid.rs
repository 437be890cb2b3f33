//! Fields on a regular grid, thinned and packed for a page.

use serde::Serialize;

use crate::report::pack::{Packed, pack};

/// Contact fields on the pixels of a regular grid, `ny` rows of `nx`.
///
/// Column `i` is at `x0 + i dx`, row `j` at `y0 + j dy`.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Columns, along the runner.
    pub nx: usize,
    /// Rows, across.
    pub ny: usize,
    /// First column [m].
    pub x0: f64,
    /// First row [m].
    pub y0: f64,
    /// Spacing of the columns [m].
    pub dx: f64,
    /// Spacing of the rows [m].
    pub dy: f64,
    /// Contact pressure [Pa].
    pub pressure: &'a [f64],
    /// Gap, infinite where there is no hull [m].
    pub gap: &'a [f64],
    /// Vertical displacement of the ice surface [m].
    pub uz: &'a [f64],
}

/// Fields of a [`Grid`] as the page's scripts read them.
#[derive(Clone, Debug, Serialize)]
pub struct PackedGrid {
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// First column [m].
    pub x0: f64,
    /// First row [m].
    pub y0: f64,
    /// Spacing of the columns [m].
    pub dx: f64,
    /// Spacing of the rows [m].
    pub dy: f64,
    /// Contact pressure [Pa].
    pub p: Packed,
    /// Gap [m].
    pub gap: Packed,
    /// Vertical displacement [m].
    pub uz: Packed,
}

impl Grid<'_> {
    /// At most about `most` columns and rows, every k-th of them and the ones of the peak among
    /// them.
    ///
    /// Values are taken, not averaged: what the page shows at a grid point is what the file holds
    /// there.
    ///
    /// # Panics
    /// Where the fields do not have `nx * ny` values.
    pub fn thinned(&self, most: [usize; 2]) -> PackedGrid {
        let count = self.nx * self.ny;
        for (name, values) in [("p", self.pressure), ("gap", self.gap), ("uz", self.uz)] {
            assert_eq!(values.len(), count, "{name} on {} x {}", self.nx, self.ny);
        }
        let peak = (0..count)
            .max_by(|&a, &b| self.pressure[a].total_cmp(&self.pressure[b]))
            .unwrap_or(0);
        let columns = every(self.nx, most[0], peak % self.nx.max(1));
        let rows = every(self.ny, most[1], peak / self.nx.max(1));
        let taken = |values: &[f64]| {
            pack(
                rows.iter()
                    .flat_map(|&j| columns.iter().map(move |&i| values[j * self.nx + i])),
            )
        };
        let first = |taken: &[usize]| taken.first().copied().unwrap_or(0) as f64;
        let stride = |taken: &[usize]| match taken {
            [a, b, ..] => (b - a) as f64,
            _ => 1.0,
        };
        PackedGrid {
            nx: columns.len(),
            ny: rows.len(),
            x0: self.x0 + first(&columns) * self.dx,
            y0: self.y0 + first(&rows) * self.dy,
            dx: stride(&columns) * self.dx,
            dy: stride(&rows) * self.dy,
            p: taken(self.pressure),
            gap: taken(self.gap),
            uz: taken(self.uz),
        }
    }
}

/// Every k-th of `0..count` with `retained` among them, at most `most` of them.
fn every(count: usize, most: usize, retained: usize) -> Vec<usize> {
    let stride = count.div_ceil(most.max(1)).max(1);
    (retained % stride..count).step_by(stride).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_peak_and_its_place() {
        let (nx, ny) = (1001, 37);
        let p = |i: usize, j: usize| {
            1e6 * (-(i as f64 - 613.0).powi(2) / 1e4 - (j as f64 - 11.0).powi(2) / 50.0).exp()
        };
        let pressure: Vec<f64> = (0..nx * ny).map(|k| p(k % nx, k / nx)).collect();
        let grid = Grid {
            nx,
            ny,
            x0: -0.5,
            y0: 0.1,
            dx: 1e-3,
            dy: 1e-4,
            pressure: &pressure,
            gap: &pressure,
            uz: &pressure,
        };
        let thin = grid.thinned([100, 20]);
        assert!(thin.nx <= 100 && thin.ny <= 20, "{} {}", thin.nx, thin.ny);
        assert_eq!((thin.dx, thin.dy), (11.0 * 1e-3, 2.0 * 1e-4));
        // 613 = 8 + 55 * 11, 11 = 1 + 5 * 2.
        assert!((thin.x0 + 0.5 - 8e-3).abs() < 1e-15);
        assert!((thin.y0 - 0.1 - 1e-4).abs() < 1e-15);
        let top = thin.p.low + 65534.0 * thin.p.step;
        assert!((top / 1e6 - 1.0).abs() < 1e-12, "{top}");
    }

    #[test]
    fn a_grid_that_is_small_enough_stays_whole() {
        assert_eq!(every(5, 5, 3), [0, 1, 2, 3, 4]);
        assert_eq!(every(6, 5, 3), [1, 3, 5]);
    }
}
