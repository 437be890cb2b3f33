//! The contact's fields on a regular grid of pixels.

use rayon::prelude::*;

use crate::result::solution::{Solution, SurfaceField};

use crate::map::hermite::Hermite;
use crate::map::rim::squared_pressure;

/// Pixels across the whole window, along each axis.
const FEWEST: usize = 384;
const MOST: usize = 3072;
/// Width of the empty frame around the contact, relative to the contact's extent.
const MARGIN: f64 = 0.25;

/// Pressure, gap and displacement on the pixels of a regular grid.
///
/// Arrays are `ny` rows of `nx`; column `i` is at `x0 + i dx`, row `j` at `y0 + j dy` (pixel centres).
#[derive(Clone, Debug, PartialEq)]
pub struct PressureMap {
    /// Centre of the first pixel along the runner [m].
    pub x0: f64,
    /// Centre of the first pixel across [m].
    pub y0: f64,
    /// Pixel size along the runner [m].
    pub dx: f64,
    /// Pixel size across [m].
    pub dy: f64,
    /// Pixels along the runner.
    pub nx: usize,
    /// Pixels across.
    pub ny: usize,
    /// Contact pressure [Pa].
    pub pressure: Vec<f64>,
    /// Gap [m].
    pub gap: Vec<f64>,
    /// Vertical displacement of the ice surface [m].
    pub uz: Vec<f64>,
}

impl PressureMap {
    /// The map of a solved contact.
    pub fn of(solution: &Solution) -> PressureMap {
        PressureMap::new(&solution.surface, solution.fz, solution.bound())
    }

    /// The fields in a window around the contact; the pressure carries the force `fz` [N] and is nowhere above `bound`, what the
    /// ice bears [Pa]; infinite for ice that bears all.
    ///
    /// It is the pressure of the mesh, whose peak is [`Solution::p_max_mesh`]: [`Solution::p_max`] is the limit of finer and finer
    /// meshes, of which there is no map.
    ///
    /// Gap and displacement are averages of the bilinear fields over the pixels; see [`pressure`] for the pressure.
    /// Where nothing touches, the window is the whole field.
    pub fn new(field: &SurfaceField, fz: f64, bound: f64) -> PressureMap {
        let columns = field.x.len();
        let touches = |i: usize, j: usize| field.pressure[j * columns + i] > 0.0;
        let touched_x: Vec<bool> = (0..columns)
            .map(|i| (0..field.y.len()).any(|j| touches(i, j)))
            .collect();
        let touched_y: Vec<bool> = (0..field.y.len())
            .map(|j| (0..columns).any(|i| touches(i, j)))
            .collect();
        let along = Axis::around(&field.x, &touched_x);
        let across = Axis::around(&field.y, &touched_y);
        let average = |values: &[f64]| average(values, columns, &along, &across);
        // What touches has no gap, whatever the solver's tolerance left of it.
        let gap: Vec<f64> = field
            .pressure
            .iter()
            .zip(&field.gap)
            .map(|(&p, gap)| if p > 0.0 { 0.0 } else { gap.max(0.0) })
            .collect();
        let (pressure, (gap, uz)) = rayon::join(
            || pressure(field, fz, bound, &along, &across),
            || rayon::join(|| average(&gap), || average(&field.uz)),
        );
        PressureMap {
            x0: along.first,
            y0: across.first,
            dx: along.step,
            dy: across.step,
            nx: along.count,
            ny: across.count,
            pressure,
            gap,
            uz,
        }
    }

    /// Pressure between pixel centres, bilinear; 0 outside the map [Pa].
    pub fn pressure_at(&self, x: f64, y: f64) -> f64 {
        let (u, v) = ((x - self.x0) / self.dx, (y - self.y0) / self.dy);
        let inside = |t: f64, count: usize| t >= 0.0 && t <= (count - 1) as f64;
        if !inside(u, self.nx) || !inside(v, self.ny) {
            return 0.0;
        }
        let (i, j) = ((u as usize).min(self.nx - 2), (v as usize).min(self.ny - 2));
        let (s, t) = (u - i as f64, v - j as f64);
        let p = |i: usize, j: usize| self.pressure[j * self.nx + i];
        (1.0 - t) * ((1.0 - s) * p(i, j) + s * p(i + 1, j))
            + t * ((1.0 - s) * p(i, j + 1) + s * p(i + 1, j + 1))
    }

    /// Position of the highest pressure [m]; on a plateau, the place nearest to the load's line of action.
    pub fn peak(&self) -> (f64, f64) {
        let highest = self.pressure.iter().copied().fold(0.0, f64::max);
        let place = |k: usize| {
            let (i, j) = (k % self.nx, k / self.nx);
            (self.x0 + i as f64 * self.dx, self.y0 + j as f64 * self.dy)
        };
        let distance = |k: &usize| {
            let (x, y) = place(*k);
            (x / self.dx).hypot(y / self.dy)
        };
        (0..self.pressure.len())
            .filter(|&k| self.pressure[k] >= highest * (1.0 - 1e-6))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .map_or((self.x0, self.y0), place)
    }
}

/// Pixels along one axis and how much of each node's hat function each of them holds.
struct Axis {
    first: f64,
    step: f64,
    count: usize,
    /// For each pixel its (node, weight) pairs; the weights of a pixel sum to one.
    weights: Vec<Vec<(usize, f64)>>,
}

impl Axis {
    fn centre(&self, pixel: usize) -> f64 {
        self.first + pixel as f64 * self.step
    }

    /// A window around the touched nodes, its pixels about as fine as the finest cell there.
    fn around(nodes: &[f64], touched: &[bool]) -> Axis {
        let last = nodes.len() - 1;
        let lowest = touched.iter().position(|&t| t).unwrap_or(0);
        let highest = touched.iter().rposition(|&t| t).unwrap_or(last);
        let (low, high) = (lowest.saturating_sub(1), (highest + 1).min(last));
        let margin = MARGIN * (nodes[high] - nodes[low]);
        let start = (nodes[low] - margin).max(nodes[0]);
        let end = (nodes[high] + margin).min(nodes[last]);
        let finest = nodes[low..=high]
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(f64::INFINITY, f64::min);
        let count = (((end - start) / finest).ceil() as usize).clamp(FEWEST, MOST);
        let step = (end - start) / count as f64;
        let weights = (0..count)
            .map(|k| {
                let from = start + k as f64 * step;
                let to = (start + (k + 1) as f64 * step).min(end);
                hat_averages(nodes, from, to)
            })
            .collect();
        Axis {
            first: start + 0.5 * step,
            step,
            count,
            weights,
        }
    }
}

/// Mean over `from..to` of each node's hat function that is not zero there.
fn hat_averages(nodes: &[f64], from: f64, to: f64) -> Vec<(usize, f64)> {
    let mut weights: Vec<(usize, f64)> = Vec::new();
    let mut add = |node: usize, weight: f64| {
        if weight <= 0.0 {
            return;
        }
        match weights.last_mut() {
            Some((last, sum)) if *last == node => *sum += weight,
            _ => weights.push((node, weight)),
        }
    };
    let first_cell = nodes.partition_point(|&x| x <= from).saturating_sub(1);
    for cell in first_cell..nodes.len() - 1 {
        let (left, right) = (nodes[cell], nodes[cell + 1]);
        if left >= to {
            break;
        }
        let (a, b) = (from.max(left), to.min(right));
        let share = (b - a) / (to - from);
        let upper = (0.5 * (a + b) - left) / (right - left);
        add(cell, share * (1.0 - upper));
        add(cell + 1, share * upper);
    }
    weights
}

/// Rows first, then columns: each pixel's value is a weighted mean of nodes.
fn average(values: &[f64], columns: usize, along: &Axis, across: &Axis) -> Vec<f64> {
    let mut pixels = Vec::with_capacity(along.count * across.count);
    let mut row = vec![0.0; columns];
    for weights in &across.weights {
        row.fill(0.0);
        for &(j, weight) in weights {
            for (sum, value) in row.iter_mut().zip(&values[j * columns..(j + 1) * columns]) {
                *sum += weight * value;
            }
        }
        pixels.extend(along.weights.iter().map(|pairs| {
            pairs
                .iter()
                .map(|&(i, weight)| weight * row[i])
                .sum::<f64>()
        }));
    }
    pixels
}

/// Pressure at the pixels' centres.
///
/// p^2 is interpolated by cubics along x and then along y, and ends at its rim below the cell (see
/// [`squared_pressure`]); then `sum p dx dy` is made the force by [`carry`], and nothing exceeds what the ice bears.
fn pressure(field: &SurfaceField, fz: f64, bound: f64, along: &Axis, across: &Axis) -> Vec<f64> {
    let (nodes, columns) = (field.y.len(), along.count);
    let squared = squared_pressure(field);
    let mut by_rows = vec![f64::NAN; nodes * columns];
    squared
        .par_chunks_exact(field.x.len())
        .zip(by_rows.par_chunks_exact_mut(columns))
        .for_each(|(row, out)| {
            let line = Hermite::new(&field.x, row);
            out.iter_mut()
                .enumerate()
                .for_each(|(i, value)| *value = line.at(along.centre(i)));
        });
    let lines: Vec<Vec<f64>> = (0..columns)
        .into_par_iter()
        .map(|i| {
            let column: Vec<f64> = (0..nodes).map(|j| by_rows[j * columns + i]).collect();
            let line = Hermite::new(&field.y, &column);
            // A gap's NaN loses against zero.
            let value = |j| line.at(across.centre(j)).max(0.0).sqrt().min(bound);
            (0..across.count).map(value).collect()
        })
        .collect();
    let mut pressure = Vec::with_capacity(columns * across.count);
    for j in 0..across.count {
        pressure.extend(lines.iter().map(|line| line[j]));
    }
    carry(&mut pressure, fz / (along.step * across.step));
    pressure
}

/// Makes the pressures' sum the one asked, p <- p (1 + c (1 - (p / p_top)^2)).
///
/// What interpolation misses lies near the rim; the peak and a plateau at the ice's hardness stay. The factor is
/// kept within a tenth.
fn carry(pressure: &mut [f64], sum: f64) {
    let top = pressure.iter().copied().fold(0.0, f64::max);
    let share = |p: f64| 1.0 - (p / top).powi(2);
    let missing = sum - pressure.iter().sum::<f64>();
    let room: f64 = pressure.iter().map(|&p| p * share(p)).sum();
    if room > 0.0 {
        let c = (missing / room).clamp(-0.1, 0.1);
        pressure.iter_mut().for_each(|p| *p *= 1.0 + c * share(*p));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::hertz_field::ellipse;

    #[test]
    fn the_map_of_a_hertz_contact_has_its_force_peak_and_area() {
        let (a, b, peak) = (0.025, 0.14e-3, 138.5e6);
        let hertz = 2.0 / 3.0 * std::f64::consts::PI * a * b * peak;
        let map = PressureMap::new(&ellipse(a, b, peak), hertz, f64::INFINITY);
        let pixel = map.dx * map.dy;
        let force: f64 = map.pressure.iter().sum::<f64>() * pixel;
        assert!((force / hertz - 1.0).abs() < 1e-9, "{force} {hertz}");
        let top = map.pressure.iter().copied().fold(0.0, f64::max);
        assert!((top / peak - 1.0).abs() < 1e-3, "{top}");
        let area = map.pressure.iter().filter(|&&p| p > 0.0).count() as f64 * pixel;
        assert!(
            (area / (std::f64::consts::PI * a * b) - 1.0).abs() < 0.01,
            "{area}"
        );
    }

    #[test]
    fn a_linear_field_is_reproduced_at_pixel_centres() {
        let mut field = ellipse(0.02, 0.01, 1e6);
        let columns = field.x.len();
        for (k, value) in field.uz.iter_mut().enumerate() {
            *value = 3.0 * field.x[k % columns] - 2.0 * field.y[k / columns] + 0.5;
        }
        let map = PressureMap::new(&field, 1.0, 1e6);
        // A pixel that lies inside one cell averages to its centre's value exactly; over a kink the
        // hat functions still sum a linear field to the same.
        for j in [0, map.ny / 3, map.ny - 1] {
            for i in [0, map.nx / 2, map.nx - 1] {
                let (x, y) = (map.x0 + i as f64 * map.dx, map.y0 + j as f64 * map.dy);
                let expected = 3.0 * x - 2.0 * y + 0.5;
                assert!((map.uz[j * map.nx + i] - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn beyond_the_hull_the_gap_is_infinite_and_never_nan() {
        let map = PressureMap::new(&ellipse(0.025, 0.14e-3, 1e6), 1.0, 1e6);
        assert!(map.gap.iter().all(|gap| !gap.is_nan()));
        let map = PressureMap::new(
            &SurfaceField {
                pressure: vec![0.0; ellipse(0.025, 0.14e-3, 1.0).pressure.len()],
                ..ellipse(0.025, 0.14e-3, 1.0)
            },
            0.0,
            f64::INFINITY,
        );
        assert!(map.gap.iter().any(|gap| gap.is_infinite()));
        assert!(map.gap.iter().all(|gap| !gap.is_nan()));
    }

    #[test]
    fn only_what_the_ice_bears_cuts_a_map() {
        let (a, b, peak) = (0.025, 0.14e-3, 138.5e6);
        let hertz = 2.0 / 3.0 * std::f64::consts::PI * a * b * peak;
        let highest = |bound: f64| {
            let map = PressureMap::new(&ellipse(a, b, peak), hertz, bound);
            let top = map.pressure.iter().copied().fold(0.0, f64::max);
            let at_top = map.pressure.iter().filter(|p| **p == top).count();
            (top, at_top)
        };
        let (whole, few) = highest(f64::INFINITY);
        assert!(
            (whole / peak - 1.0).abs() < 1e-3 && few <= 8,
            "{whole} {few}"
        );
        let (cut, many) = highest(100e6);
        assert!(cut == 100e6 && many > 1000, "{cut} {many}");
    }
}
