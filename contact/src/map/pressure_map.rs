//! The contact's fields on a regular grid of pixels.

use std::ops::Range;

use rayon::prelude::*;

use crate::map::rim::squared_pressure;
use crate::result::solution::{Solution, SurfaceField};

/// Smallest and largest number of pixels of a window along each axis.
const MIN_PIXELS: usize = 384;
const MAX_PIXELS: usize = 8192;
/// Width of the empty frame around the contact, relative to the contact's extent.
const MARGIN: f64 = 0.25;

/// Pressure, gap and displacement on the pixels of a regular grid.
///
/// Arrays are `ny` rows of `nx`; column `i` is at `x0 + i dx`, row `j` at `y0 + j dy` (pixel
/// centres).
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

    /// The fields in a window around the contact. The pressure integrates to the force `fz` [N] and
    /// is nowhere above `bound`, the hardness of the ice [Pa] (infinite for elastic ice).
    ///
    /// It is the pressure of the last mesh, whose peak is [`Solution::p_max_mesh`].
    /// [`Solution::p_max`] is the extrapolated limit of finer meshes, which has no map.
    ///
    /// Gap and displacement are averages of the bilinear fields over the pixels; see [`pressure`]
    /// for the pressure. Without contact, the window is the whole field.
    pub fn new(field: &SurfaceField, fz: f64, bound: f64) -> PressureMap {
        let (columns, rows) = (field.x.len(), field.y.len());
        let touches = |i: usize, j: usize| field.pressure[j * columns + i] > 0.0;
        let along = Axis::around(&field.x, |i| (0..rows).any(|j| touches(i, j)));
        let across = Axis::around(&field.y, |j| (0..columns).any(|i| touches(i, j)));
        let average = |values: &[f64]| average(values, columns, &along, &across);
        // The gap of nodes in contact is 0; the solver's tolerance may leave a small one.
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

    /// Position of the highest pressure (x, y) [m]; on a plateau, the point nearest to the load's
    /// line of action.
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

/// Pixels along one axis, with the weights of the nodes' hat functions in each.
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
    fn around(nodes: &[f64], touched: impl Fn(usize) -> bool) -> Axis {
        let last = nodes.len() - 1;
        let lowest = (0..nodes.len()).position(&touched).unwrap_or(0);
        let highest = (0..nodes.len()).rposition(&touched).unwrap_or(last);
        let (low, high) = (lowest.saturating_sub(1), (highest + 1).min(last));
        let margin = MARGIN * (nodes[high] - nodes[low]);
        let start = (nodes[low] - margin).max(nodes[0]);
        let end = (nodes[high] + margin).min(nodes[last]);
        let finest = nodes[low..=high]
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(f64::INFINITY, f64::min);
        let count = (((end - start) / finest).ceil() as usize).clamp(MIN_PIXELS, MAX_PIXELS);
        let step = (end - start) / count as f64;
        let weights = |k: usize| {
            let from = start + k as f64 * step;
            let to = (start + (k + 1) as f64 * step).min(end);
            hat_averages(nodes, from, to)
        };
        Axis {
            first: start + 0.5 * step,
            step,
            count,
            weights: (0..count).map(weights).collect(),
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
        let mean = |pairs: &Vec<(usize, f64)>| -> f64 {
            pairs.iter().map(|&(i, weight)| weight * row[i]).sum()
        };
        pixels.extend(along.weights.iter().map(mean));
    }
    pixels
}

/// Pressure at the pixels' centres.
///
/// p^2 is interpolated by cubics along x and then along y, and ends at its rim below the cell (see
/// [`squared_pressure`]); then `sum p dx dy` is made the force by [`carry`], and nothing exceeds
/// what the ice bears.
fn pressure(field: &SurfaceField, fz: f64, bound: f64, along: &Axis, across: &Axis) -> Vec<f64> {
    let (nodes, columns) = (field.y.len(), along.count);
    let squared = squared_pressure(field, bound);
    let by_rows: Vec<f64> = squared
        .par_chunks_exact(field.x.len())
        .flat_map_iter(|row| {
            let line = Hermite::new(&field.x, row);
            (0..columns).map(move |i| line.at(along.centre(i)))
        })
        .collect();
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

/// Scales the pressures to the requested sum, p <- p (1 + c (1 - (p / p_top)^2)).
///
/// The error of the interpolation lies near the rim; the peak and a plateau at the ice's hardness
/// do not change. The factor c is limited to a tenth.
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

// Interpolation along a line with gaps.

/// A piecewise cubic through values on increasing nodes; NaN marks nodes without a value.
///
/// Slopes come from the parabola through a node and its neighbours (one-sided next to a gap), so
/// parabolas are reproduced exactly. A cell with a NaN end is a gap. Between two values that are
/// not positive the value is not positive; between two positive ones it is not lower than both; and
/// from a positive to a non-positive one it falls monotonically, however steep the adjacent cells
/// are.
pub struct Hermite<'a> {
    nodes: &'a [f64],
    values: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> Hermite<'a> {
    /// Prepares the slopes of `values` at `nodes`.
    pub fn new(nodes: &'a [f64], values: &'a [f64]) -> Hermite<'a> {
        let slopes = (0..nodes.len()).map(|k| slope(nodes, values, k)).collect();
        Hermite {
            nodes,
            values,
            slopes,
        }
    }

    /// The value at `x`; NaN in a gap and outside the ends.
    pub fn at(&self, x: f64) -> f64 {
        let above = self.nodes.partition_point(|&node| node <= x);
        if above == 0 || above == self.nodes.len() {
            return f64::NAN;
        }
        let (left, right) = (above - 1, above);
        let width = self.nodes[right] - self.nodes[left];
        let t = (x - self.nodes[left]) / width;
        let rise = self.values[right] - self.values[left];
        let (mut from, mut to) = (self.slopes[left] * width, self.slopes[right] * width);
        let [low, high] = [self.values[left], self.values[right]];
        if low.is_nan() || high.is_nan() {
            return f64::NAN;
        }
        if (low > 0.0) != (high > 0.0) {
            [from, to] =
                [from, to].map(|slope| slope.clamp(rise.min(0.0) * 3.0, rise.max(0.0) * 3.0));
        }
        // h(t) = v + t (m0 + t (3 d - 2 m0 - m1 + t (m0 + m1 - 2 d))), d the rise, m the slopes
        // over the cell
        let value = self.values[left]
            + t * (from + t * (3.0 * rise - 2.0 * from - to + t * (from + to - 2.0 * rise)));
        // A cubic may overshoot zero between two values that are not positive, where there is no
        // contact.
        match (low > 0.0, high > 0.0) {
            (false, false) => value.min(0.0),
            (true, true) => value.max(low.min(high)),
            _ => value,
        }
    }
}

fn slope(nodes: &[f64], values: &[f64], k: usize) -> f64 {
    let known = |k: usize| values.get(k).is_some_and(|v| !v.is_nan());
    let difference = |a: usize, b: usize| (values[b] - values[a]) / (nodes[b] - nodes[a]);
    if !known(k) {
        return f64::NAN;
    }
    match (k > 0 && known(k - 1), known(k + 1)) {
        (true, true) => {
            let (before, after) = (nodes[k] - nodes[k - 1], nodes[k + 1] - nodes[k]);
            (difference(k - 1, k) * after + difference(k, k + 1) * before) / (before + after)
        }
        (false, true) if known(k + 2) => {
            let bend = difference(k + 1, k + 2) - difference(k, k + 1);
            let share = (nodes[k + 1] - nodes[k]) / (nodes[k + 2] - nodes[k]);
            difference(k, k + 1) - bend * share
        }
        (true, false) if k > 1 && known(k - 2) => {
            let bend = difference(k - 1, k) - difference(k - 2, k - 1);
            let share = (nodes[k] - nodes[k - 1]) / (nodes[k] - nodes[k - 2]);
            difference(k - 1, k) + bend * share
        }
        (false, true) => difference(k, k + 1),
        (true, false) => difference(k - 1, k),
        (false, false) => 0.0,
    }
}

// Separate maps of contacts that are far apart along the runner, such as a runner that rests on its
// two ends.

/// Ratio of the empty stretch between two contacts to their length from which they get a map each.
const MIN_EMPTY_RATIO: f64 = 5.0;

/// One map for the whole contact, or two where it consists of two parts that are far apart along
/// the runner.
pub fn pressure_maps(solution: &Solution) -> Vec<PressureMap> {
    let field = &solution.surface;
    let Some(parts) = split(&field.x, &field.pressure) else {
        return vec![PressureMap::of(solution)];
    };
    let parts = parts.map(|columns| cropped(field, columns));
    let forces = parts.each_ref().map(SurfaceField::force);
    let part = |k: usize| {
        let fz = solution.fz * forces[k] / (forces[0] + forces[1]);
        PressureMap::new(&parts[k], fz, solution.bound())
    };
    vec![part(0), part(1)]
}

/// The map, or two maps if it shows two parts that are far apart, each with a margin around its
/// contact.
pub fn parted(map: PressureMap) -> Vec<PressureMap> {
    let x: Vec<f64> = (0..map.nx).map(|i| map.x0 + i as f64 * map.dx).collect();
    match split(&x, &map.pressure) {
        None => vec![map],
        Some(parts) => parts.map(|columns| part(&map, columns)).into(),
    }
}

/// The columns of a part that are in contact, with half as many again around them.
fn part(map: &PressureMap, columns: Range<usize>) -> PressureMap {
    let touches = |&i: &usize| map.pressure.chunks(map.nx).any(|row| row[i] > 0.0);
    let first = columns.clone().find(touches).unwrap_or(columns.start);
    let last = columns.clone().rfind(touches).unwrap_or(columns.end - 1);
    let margin = (last - first).div_ceil(4).max(2);
    let from = first.saturating_sub(margin).max(columns.start);
    let to = (last + 1 + margin).min(columns.end);
    let crop = |values: &[f64]| -> Vec<f64> {
        let rows = values.chunks(map.nx);
        rows.flat_map(|row| row[from..to].iter().copied()).collect()
    };
    PressureMap {
        x0: map.x0 + from as f64 * map.dx,
        nx: to - from,
        pressure: crop(&map.pressure),
        gap: crop(&map.gap),
        uz: crop(&map.uz),
        ..*map
    }
}

/// The columns, at `x`, on both sides of the middle of the longest empty stretch of these rows of
/// pressures; `None` if that stretch is short ([`MIN_EMPTY_RATIO`]).
fn split(x: &[f64], pressure: &[f64]) -> Option<[Range<usize>; 2]> {
    let columns = x.len();
    let touched: Vec<usize> = (0..columns)
        .filter(|&i| pressure.chunks(columns).any(|row| row[i] > 0.0))
        .collect();
    let length = |pair: &[usize]| x[pair[1]] - x[pair[0]];
    let widest = touched
        .windows(2)
        .max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let whole = x[*touched.last()?] - x[touched[0]];
    let empty = length(widest);
    if empty < MIN_EMPTY_RATIO * (whole - empty) {
        return None;
    }
    let middle = 0.5 * (x[widest[0]] + x[widest[1]]);
    let at = x.partition_point(|&x| x < middle);
    // Each part keeps an empty column on the inside.
    (widest[1] > widest[0] + 2 && at > widest[0] + 1).then_some([0..at, at..columns])
}

fn cropped(field: &SurfaceField, columns: Range<usize>) -> SurfaceField {
    let crop = |values: &[f64]| {
        values
            .chunks(field.x.len())
            .flat_map(|row| row[columns.clone()].iter().copied())
            .collect()
    };
    SurfaceField {
        x: field.x[columns.clone()].to_vec(),
        y: field.y.clone(),
        pressure: crop(&field.pressure),
        gap: crop(&field.gap),
        yielded: crop(&field.yielded),
        uz: crop(&field.uz),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Hertz's ellipse of pressure on a graded grid, its gap infinite outside `|y| = 2 b`.
    pub fn ellipse(a: f64, b: f64, peak: f64) -> SurfaceField {
        let graded = |half: f64| -> Vec<f64> {
            let mut side: Vec<f64> = (1..=40).map(|k| half * 1.05 * k as f64 / 40.0).collect();
            side.extend((1..=12).map(|k| half * (1.05 + 0.05 * 1.4f64.powi(k))));
            let mut nodes: Vec<f64> = side.iter().rev().map(|x| -x).collect();
            nodes.push(0.0);
            nodes.extend(side);
            nodes
        };
        let (x, y) = (graded(a), graded(b));
        let mut field = SurfaceField {
            x: x.clone(),
            y: y.clone(),
            pressure: Vec::new(),
            gap: Vec::new(),
            yielded: vec![0.0; x.len() * y.len()],
            uz: Vec::new(),
        };
        for &yj in &y {
            for &xi in &x {
                let inside = 1.0 - (xi / a).powi(2) - (yj / b).powi(2);
                field.pressure.push(peak * inside.max(0.0).sqrt());
                field.gap.push(if yj.abs() > 2.0 * b {
                    f64::INFINITY
                } else {
                    (-inside).max(0.0) * 1e-5
                });
                field.uz.push(-1e-5 * (1.0 + inside.max(-2.0)));
            }
        }
        field
    }

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

#[cfg(test)]
mod hermite_tests {
    use super::*;

    #[test]
    fn between_values_that_are_not_positive_nothing_is() {
        let (nodes, values) = ([0.0, 1.0, 2.0, 3.0], [-9.0, -0.1, -0.1, -9.0]);
        let line = Hermite::new(&nodes, &values);
        assert!((0..=300).all(|k| line.at(0.01 * f64::from(k)).max(0.0) == 0.0));
    }

    #[test]
    fn beside_steep_cells_nothing_is_lower_than_its_neighbours_and_rims_are_crossed_once() {
        let nodes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let values = [1.0, 1.0, 1.0, 40.0, 3.0, -90.0];
        let line = Hermite::new(&nodes, &values);
        let at: Vec<f64> = (0..500).map(|k| line.at(0.01 * f64::from(k))).collect();
        assert!(at[..400].iter().all(|v| *v >= 1.0));
        assert!(at[400..].is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn parabolas_are_reproduced_up_to_the_gap_and_not_beyond() {
        let nodes = [-1.0, -0.4, 0.1, 0.3, 1.0, 1.7, 2.0];
        let parabola = |x: f64| 2.0 - 3.0 * x + 0.7 * x * x;
        let mut values: Vec<f64> = nodes.iter().map(|&x| parabola(x)).collect();
        values[6] = f64::NAN;
        let line = Hermite::new(&nodes, &values);
        for k in 0..100 {
            let x = -1.0 + 2.7 * f64::from(k) / 100.0;
            assert!((line.at(x) - parabola(x)).abs() < 1e-12, "{x}");
        }
        assert!(line.at(1.8).is_nan() && line.at(-1.1).is_nan() && line.at(2.5).is_nan());
    }
}

#[cfg(test)]
mod patches_tests {
    use super::*;

    /// Pressure 1 Pa where `touches`, on nodes 0..=40 by 0..=2 m.
    fn field(touches: impl Fn(usize) -> bool) -> SurfaceField {
        let x: Vec<f64> = (0..=40).map(f64::from).collect();
        let row: Vec<f64> = (0..=40).map(|i| f64::from(u8::from(touches(i)))).collect();
        let pressure = [vec![0.0; 41], row, vec![0.0; 41]].concat();
        SurfaceField {
            x,
            y: vec![0.0, 1.0, 2.0],
            gap: vec![0.0; pressure.len()],
            yielded: vec![0.0; pressure.len()],
            uz: vec![0.0; pressure.len()],
            pressure,
        }
    }

    #[test]
    fn a_contact_on_two_ends_is_parted_in_the_middle_and_its_force_kept() {
        let two = field(|i| (2..=3).contains(&i) || (36..=38).contains(&i));
        let [left, right] = split(&two.x, &two.pressure)
            .expect("two parts")
            .map(|part| cropped(&two, part));
        assert_eq!((left.x[0], right.x[right.x.len() - 1]), (0.0, 40.0));
        assert_eq!((left.force(), right.force()), (2.0, 3.0));
    }

    #[test]
    fn a_map_of_two_ends_is_cut_into_two_maps_that_keep_their_places() {
        let two = field(|i| (2..=3).contains(&i) || (36..=38).contains(&i));
        let map = PressureMap {
            x0: 0.0,
            y0: 0.0,
            dx: 1.0,
            dy: 1.0,
            nx: 41,
            ny: 3,
            pressure: two.pressure,
            gap: two.gap,
            uz: two.uz,
        };
        let [left, right]: [PressureMap; 2] = parted(map).try_into().expect("two parts");
        assert_eq!((left.x0, left.nx, right.x0, right.nx), (0.0, 6, 34.0, 7));
        assert_eq!(left.pressure[6..12], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(right.pressure[7..14], [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_single_contact_and_two_near_ones_stay_whole() {
        let parts = |of: SurfaceField| split(&of.x, &of.pressure);
        assert_eq!(parts(field(|i| (10..=30).contains(&i))), None);
        let near = field(|i| (5..=15).contains(&i) || (25..=35).contains(&i));
        assert_eq!(parts(near), None);
    }
}
