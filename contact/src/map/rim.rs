//! The rim of the contact with sub-cell resolution.

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

use crate::result::measure::ROUNDED;
use crate::result::solution::SurfaceField;

/// Number of nodes on each side of a node in its paraboloid fit, and the distance in nodes at which
/// their weight is 1 / e.
const REACH: usize = 4;
const SPREAD: f64 = 2.0;
/// Weight of nodes next to the rim, whose pressures are means, relative to inner nodes.
const RIM_WEIGHT: f64 = 0.1;
/// Ratio of the slope with which the pressure of yielding ice falls to zero at its rim to that over
/// one cell.
const STEEPNESS: f64 = 10.0;
/// Smallest ratio of the overlap to the mean gap of the open nodes for which the rim is taken at
/// zero overlap.
const MIN_OVERLAP: f64 = 0.1;

/// The square of the pressure at the nodes, continued to negative values just outside the contact;
/// NaN farther out.
///
/// The square of a smooth contact's pressure is smooth through the rim, where it passes zero (it is
/// a paraboloid in Hertz's contact): the root of its positive part ends at the rim of the contact,
/// not at a node. The pressure of a node next to the rim is a mean over its hat function, which
/// reaches out of the contact.
///
/// - Nodes with an open node among their eight neighbours, and these open nodes, take the value of
///   a paraboloid through the nodes around them (weighted least squares), which the inner nodes
///   dominate.
/// - If the paraboloid does not fall outwards (at an edge of the hull) or has too few nodes, the
///   rim lies half-way between nodes.
/// - Next to nodes at the hardness, `bound` [Pa], the rim lies where the ice begins to yield: where
///   the overlap with the elastic surface is zero or, in sliding, where the groove begins.
/// - A node there with a pressure below the hardness, in ice that has not yielded, is crossed by
///   the rim: at half the hardness, half of its hat function is in contact.
pub fn squared_pressure(field: &SurfaceField, bound: f64) -> Vec<f64> {
    let square: Vec<f64> = field.pressure.iter().map(|p| p * p).collect();
    let nodes = Nodes::new(field, &square);
    let count = square.len();
    let fitted: Vec<f64> = (0..count)
        .into_par_iter()
        .map(|n| match nodes.place[n] {
            Place::AtRim | Place::Open => nodes.fitted(n),
            Place::Within | Place::Far => f64::NAN,
        })
        .collect();
    let full = |n: usize| field.pressure[n] >= ROUNDED * bound;
    let yields = |n: usize| nodes.block(n, 1).any(full);
    // Next to nodes that yield, or to nodes below the hardness that are next to such nodes.
    let jumps = |n: usize| yields(n) || nodes.facing(n).all(yields);
    let closest = closest(field);
    // Behind the yielding part, the ice presses elastically on the rising runner.
    let recovers = |n: usize| square[n] > 0.0 && !full(n) && field.yielded[n] > 0.0;
    // Ice next to such a part of the groove: the rim is the wall of the groove, formed ahead.
    let walled = |n: usize| field.yielded[n] <= 0.0 && nodes.facing(n).any(recovers);
    let wall = |n: usize| {
        let recovering = || nodes.facing(n).filter(|&k| recovers(k));
        let falls = recovering()
            .map(|k| square[k] / field.yielded[k])
            .sum::<f64>();
        -closest[n] * falls / recovering().count() as f64
    };
    let touching = |n: usize| nodes.block(n, 1).filter(|&k| square[k] > 0.0);
    let mean = |n: usize| touching(n).map(|k| square[k]).sum::<f64>() / touching(n).count() as f64;
    // An open node where the fitted surface has fallen to zero from the nodes in contact.
    let ended = |n: usize| {
        nodes.place[n] == Place::Open && fitted[n] < 0.5 * mean(n) && !jumps(n) && !walled(n)
    };
    // The gap over the ice before it yields; a groove behind the runner is not the beginning of a
    // rim.
    let before = |n: usize| match field.gap[n] - field.yielded[n] {
        gap if gap >= 0.0 => gap,
        _ => f64::NAN,
    };
    let steep = STEEPNESS * bound * bound / overlap(field, &nodes.place, bound);
    (0..count)
        .into_par_iter()
        .map(|n| match nodes.place[n] {
            Place::Within if full(n) && steep > 0.0 && !nodes.block(n, 2).any(recovers) => {
                (steep * field.yielded[n]).max(square[n])
            }
            Place::AtRim if full(n) && steep > 0.0 => steep * field.yielded[n],
            Place::AtRim if yields(n) && steep > 0.0 && field.yielded[n] <= 0.0 => {
                STEEPNESS * bound * (field.pressure[n] - 0.5 * bound)
            }
            Place::Open if walled(n) && closest[n].is_finite() => wall(n),
            Place::Open if jumps(n) && steep > 0.0 && before(n).is_finite() => -steep * before(n),
            Place::AtRim if nodes.block(n, 1).any(ended) => fitted[n],
            Place::Within | Place::AtRim => square[n],
            Place::Open if ended(n) => fitted[n].min(0.0),
            Place::Open => -mean(n),
            Place::Far => f64::NAN,
        })
        .collect()
}

/// The smallest gap over each node and those ahead of it [m].
fn closest(field: &SurfaceField) -> Vec<f64> {
    let mut closest = field.gap.clone();
    for row in closest.chunks_exact_mut(field.x.len()) {
        for i in (1..row.len()).rev() {
            row[i - 1] = row[i - 1].min(row[i]);
        }
    }
    closest
}

/// Mean depth to which the ice has yielded next to the rim [m]; infinite if it has not.
fn overlap(field: &SurfaceField, place: &[Place], bound: f64) -> f64 {
    let yields = |n: &usize| place[*n] == Place::AtRim && field.pressure[*n] >= ROUNDED * bound;
    let overlaps = (0..place.len()).filter(yields).map(|n| field.yielded[n]);
    let open = (0..place.len()).filter(|&n| place[n] == Place::Open && field.gap[n].is_finite());
    let [overlap, gap] = [overlaps.collect(), open.map(|n| field.gap[n]).collect()]
        .map(|of: Vec<f64>| of.iter().sum::<f64>() / of.len() as f64);
    if overlap > MIN_OVERLAP * gap {
        overlap
    } else {
        f64::INFINITY
    }
}

/// Position of a node relative to the contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// It and its eight neighbours are in contact.
    Within,
    /// It is in contact, and a neighbour is open or does not exist.
    AtRim,
    /// It is open, and a neighbour is in contact.
    Open,
    /// It and its neighbours are open.
    Far,
}

/// The contact plane's nodes with the square of their pressure [Pa^2].
struct Nodes<'a> {
    x: &'a [f64],
    y: &'a [f64],
    square: &'a [f64],
    place: Vec<Place>,
}

impl Nodes<'_> {
    fn new<'a>(field: &'a SurfaceField, square: &'a [f64]) -> Nodes<'a> {
        let mut nodes = Nodes {
            x: &field.x,
            y: &field.y,
            square,
            place: Vec::new(),
        };
        let place = |n: usize| {
            let touching = nodes.block(n, 1).filter(|&k| square[k] > 0.0).count();
            match (square[n] > 0.0, touching) {
                (true, 9) => Place::Within,
                (true, _) => Place::AtRim,
                (false, 0) => Place::Far,
                (false, _) => Place::Open,
            }
        };
        nodes.place = (0..square.len()).map(place).collect();
        nodes
    }

    /// The nodes at most `reach` columns and rows away, including the node itself.
    fn block(&self, node: usize, reach: usize) -> impl Iterator<Item = usize> + use<> {
        let [columns, rows] = [self.x.len(), self.y.len()];
        let [i, j] = [node % columns, node / columns];
        let near = move |k: usize, last: usize| k.saturating_sub(reach)..=(k + reach).min(last);
        near(j, rows - 1).flat_map(move |j| near(i, columns - 1).map(move |i| j * columns + i))
    }

    /// The nodes in contact among the four neighbours of a node; if there are none, among its eight
    /// neighbours.
    fn facing(&self, node: usize) -> impl Iterator<Item = usize> + use<'_> {
        let columns = self.x.len();
        let straight =
            move |k: usize| k % columns == node % columns || k / columns == node / columns;
        let touching = move |k: &usize| self.square[*k] > 0.0;
        let any = self.block(node, 1).filter(touching).any(straight);
        let near = self.block(node, 1).filter(touching);
        near.filter(move |&k| !any || straight(k))
    }

    /// The value at a node of the paraboloid through the nodes in contact around it; NaN if they do
    /// not determine one.
    fn fitted(&self, node: usize) -> f64 {
        let columns = self.x.len();
        let [i, j] = [node % columns, node / columns];
        let cell = |at: &[f64], k: usize| {
            let [low, high] = [k.saturating_sub(1), (k + 1).min(at.len() - 1)];
            (at[high] - at[low]) / (high - low) as f64
        };
        let [dx, dy] = [cell(self.x, i), cell(self.y, j)];
        let mut normal = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        for k in self.block(node, REACH) {
            let share = match self.place[k] {
                Place::Within => 1.0,
                Place::AtRim => RIM_WEIGHT,
                Place::Open | Place::Far => continue,
            };
            let [column, row] = [k % columns, k / columns];
            let apart = column.abs_diff(i).pow(2) + row.abs_diff(j).pow(2);
            let weight = share * (-(apart as f64) / (SPREAD * SPREAD)).exp();
            let u = (self.x[column] - self.x[i]) / dx;
            let v = (self.y[row] - self.y[j]) / dy;
            let terms = SVector::from([1.0, u, v, u * u, u * v, v * v]);
            normal += weight * terms * terms.transpose();
            right += weight * self.square[k] * terms;
        }
        let scale = normal.diagonal();
        match normal.cholesky() {
            // Each term is independent of the others up to rounding.
            Some(factor) if (0..6).all(|k| factor.l()[(k, k)].powi(2) > 1e-9 * scale[k]) => {
                factor.solve(&right)[0]
            }
            _ => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::pressure_map::PressureMap;
    use crate::map::pressure_map::tests::ellipse;

    #[test]
    fn a_hertz_contact_is_continued_by_its_own_paraboloid() {
        let (a, b, peak) = (0.025, 0.14e-3, 138.5e6);
        let field = ellipse(a, b, peak);
        let extended = squared_pressure(&field, f64::INFINITY);
        let nx = field.x.len();
        let mut continued = 0;
        for (n, value) in extended.iter().enumerate() {
            let exact =
                peak * peak * (1.0 - (field.x[n % nx] / a).powi(2) - (field.y[n / nx] / b).powi(2));
            if !value.is_nan() {
                continued += usize::from(field.pressure[n] == 0.0);
                assert!(
                    (value - exact).abs() < 1e-6 * peak * peak,
                    "{value} {exact}"
                );
            }
        }
        assert!(continued > 100, "{continued}");
    }

    /// A unit disk on a square grid of `cells` cells over its radius; pressures and gaps from the
    /// distance to the middle.
    fn disk(cells: f64, of: impl Fn(f64, f64) -> (f64, f64)) -> SurfaceField {
        let last = cells.ceil() as i32 + 3;
        let nodes: Vec<f64> = (-last..=last).map(|k| f64::from(k) / cells).collect();
        let at = |k: usize| of(nodes[k % nodes.len()], nodes[k / nodes.len()]);
        let (pressure, gap): (Vec<f64>, Vec<f64>) = (0..nodes.len().pow(2)).map(at).unzip();
        SurfaceField {
            yielded: gap.iter().map(|gap| (-gap).max(0.0)).collect(),
            x: nodes.clone(),
            y: nodes.clone(),
            pressure,
            gap,
            uz: vec![0.0; nodes.len().pow(2)],
        }
    }

    #[test]
    fn means_over_hat_functions_are_continued_within_four_hundredths_of_the_peak() {
        for cells in [5.3, 6.5, 8.8] {
            let hertz = |x: f64, y: f64| (1.0 - x * x - y * y).max(0.0).sqrt();
            // The mean of Hertz's pressure over the hat function of a node that touches.
            let mean = |x: f64, y: f64| {
                if x.hypot(y) >= 1.0 {
                    return (0.0, 0.0);
                }
                let steps = (0..40).map(|k| (f64::from(k) - 19.5) / 20.0);
                let hat = |t: f64| (1.0 - t.abs()) / 20.0;
                let row = |t: f64| {
                    let at = |s: f64| hat(s) * hertz(x + s / cells, y + t / cells);
                    hat(t) * steps.clone().map(at).sum::<f64>()
                };
                (steps.clone().map(row).sum(), 0.0)
            };
            let field = disk(cells, mean);
            let extended = squared_pressure(&field, f64::INFINITY);
            let nx = field.x.len();
            for (n, value) in extended.iter().enumerate().filter(|(_, v)| !v.is_nan()) {
                let [x, y] = [field.x[n % nx], field.y[n / nx]];
                let exact = 1.0 - x * x - y * y;
                let off = value - exact;
                let outside = (-exact).max(0.0);
                assert!(
                    off.abs() < 0.04 + 0.25 * outside,
                    "{cells} ({x:.2}, {y:.2}): {value:.3}, {exact:.3}"
                );
            }
        }
    }

    #[test]
    fn ice_that_yields_ends_where_the_overlap_does() {
        for cells in [5.3, 6.5, 8.8] {
            let field = disk(cells, |x, y| {
                let overlap = 1.0 - x * x - y * y;
                (f64::from(u8::from(overlap > 0.0)), -overlap)
            });
            let extended = squared_pressure(&field, 1.0);
            let nx = field.x.len();
            let mut ends = 0;
            for n in 0..extended.len() - 1 {
                let [p, q] = [extended[n], extended[n + 1]];
                if p > 0.0 && q <= 0.0 && n % nx + 1 < nx {
                    ends += 1;
                    let y = field.y[n / nx];
                    let x = field.x[n % nx] + p / (p - q) / cells;
                    assert!((x.hypot(y) - 1.0).abs() < 0.02, "{cells}: {x} {y}");
                }
            }
            assert!(ends > 8, "{ends}");
        }
    }

    /// A disk whose ice bears 1 all over: nodes on the rim bear what part of their hat functions
    /// presses.
    #[test]
    fn ice_that_yields_has_a_map_with_its_force_and_without_holes() {
        for cells in [5.3, 6.5, 8.8, 17.2] {
            let field = disk(cells, |x, y| {
                let steps = || (0..40).map(|k| (f64::from(k) - 19.5) / 20.0);
                let hat = |t: f64| (1.0 - t.abs()) / 20.0;
                let row = |t: f64| -> f64 {
                    let inside = |s: &f64| (x + s / cells).hypot(y + t / cells) < 1.0;
                    steps().filter(inside).map(hat).sum::<f64>() * hat(t)
                };
                let pressed: f64 = steps().map(row).sum();
                let gap = if pressed > 0.0 && pressed < 0.999 {
                    0.0
                } else {
                    x * x + y * y - 1.0
                };
                (if pressed < 0.999 { pressed } else { 1.0 }, gap)
            });
            let map = PressureMap::new(&field, std::f64::consts::PI, 1.0);
            let force = map.pressure.iter().sum::<f64>() * map.dx * map.dy;
            assert!(
                (force / std::f64::consts::PI - 1.0).abs() < 0.25 / cells,
                "{cells}: {force}"
            );
            for (k, p) in map.pressure.iter().enumerate() {
                let [i, j] = [k % map.nx, k / map.nx];
                let r = (map.x0 + i as f64 * map.dx).hypot(map.y0 + j as f64 * map.dy);
                let near = 1.0 / cells;
                assert!(r > 1.0 - near || *p > 0.9, "{cells}: {p} at {r}");
                assert!(r < 1.0 + near || *p == 0.0, "{cells}: {p} at {r}");
            }
        }
    }

    #[test]
    fn a_field_without_contact_stays_without() {
        let mut field = ellipse(0.025, 0.14e-3, 1.0);
        field.pressure.fill(0.0);
        assert!(
            squared_pressure(&field, f64::INFINITY)
                .iter()
                .all(|q| q.is_nan())
        );
    }
}
