//! Fields on a regular grid, thinned and packed for a page.

use kufe_contact::PressureMap;
use serde::Serialize;

use crate::results::{Packed, pack};

/// Fields of a map in the form that scripts of pages read.
#[derive(Clone, Debug, Serialize)]
pub struct PackedGrid {
    /// Number of columns.
    pub nx: usize,
    /// Number of rows.
    pub ny: usize,
    /// Coordinate of the first column [m].
    pub x0: f64,
    /// Coordinate of the first row [m].
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

impl PackedGrid {
    /// Every k-th column and row of a map, about `max_points` at most, including those of the peak.
    ///
    /// Values are selected, not averaged: at a grid point the page shows the value of the file.
    pub fn thinned(map: &PressureMap, max_points: [usize; 2]) -> PackedGrid {
        let peak = (0..map.nx * map.ny)
            .max_by(|&a, &b| map.pressure[a].total_cmp(&map.pressure[b]))
            .unwrap_or(0);
        let (columns, dx) = every(map.nx, max_points[0], peak % map.nx.max(1));
        let (rows, dy) = every(map.ny, max_points[1], peak / map.nx.max(1));
        let taken = |values: &[f64]| {
            let rows = rows.iter();
            pack(rows.flat_map(|&j| columns.iter().map(move |&i| values[j * map.nx + i])))
        };
        let first = |taken: &[usize]| taken.first().copied().unwrap_or(0) as f64;
        PackedGrid {
            nx: columns.len(),
            ny: rows.len(),
            x0: map.x0 + first(&columns) * map.dx,
            y0: map.y0 + first(&rows) * map.dy,
            dx: dx as f64 * map.dx,
            dy: dy as f64 * map.dy,
            p: taken(&map.pressure),
            gap: taken(&map.gap),
            uz: taken(&map.uz),
        }
    }
}

/// Every k-th of `0..count`, at most `max_points` of them and including `retained`; and k.
fn every(count: usize, max_points: usize, retained: usize) -> (Vec<usize>, usize) {
    let stride = count.div_ceil(max_points.max(1)).max(1);
    ((retained % stride..count).step_by(stride).collect(), stride)
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
        let map = PressureMap {
            nx,
            ny,
            x0: -0.5,
            y0: 0.1,
            dx: 1e-3,
            dy: 1e-4,
            gap: pressure.clone(),
            uz: pressure.clone(),
            pressure,
        };
        let thin = PackedGrid::thinned(&map, [100, 20]);
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
        assert_eq!(every(5, 5, 3), (vec![0, 1, 2, 3, 4], 1));
        assert_eq!(every(6, 5, 3), (vec![1, 3, 5], 2));
    }
}
