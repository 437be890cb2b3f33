//! Placing breakpoints where the interpolation is worst.
//!
//! Each round solves the nodes and, on every interval of an axis to be refined, its middle on every other grid
//! line. An interval whose error there is above [`MARGIN`] of what was asked is halved; the solves just made become nodes.
//! When no interval is, points spread evenly over the table (Roberts' R2 sequence) are solved and measured: a miss halves
//! the interval around it, unless the solver's own error is as large as the miss. The sweep ends when every solve that is no node is met within what was asked. Axes given by
//! their values stay as they are, and what the interpolation misses between those values is measured but not mended.

use std::collections::HashMap;

use crate::sweep::{Plan, SolveBatch, Spacing};
use crate::table::relative_error;
use crate::{Axes, Check, Error, Lookup, MAX_AXIS, Mode, Point, Quantity, Solved, Table};

/// Part of the asked error that an interval's middle may have: between the checks it may be larger.
const MARGIN: f64 = 0.8;

pub(crate) struct Refinement {
    pub axes: Axes,
    pub nodes: Vec<Solved>,
    pub checks: Vec<Check>,
    pub shortfall: Option<Error>,
}

/// Force, curvature, rocker radius; the radius is absent (one value, ignored) without that axis.
struct Grid {
    values: [Vec<f64>; 3],
    refined: [bool; 3],
    has_rocker: bool,
}

type Key = [u64; 3];

pub(crate) fn refine<E: From<Error>>(
    plan: &Plan,
    solve: &mut SolveBatch<E>,
) -> Result<Refinement, E> {
    let mut grid = Grid::start(plan)?;
    let mut known: Known = Known::default();
    let mut spread = false;
    loop {
        let mut points = grid.axes()?.points();
        points.extend(grid.middles());
        if spread {
            points.extend(grid.spread(plan.checks));
        }
        known.solve(&points, solve)?;
        let (axes, nodes, checks) = known.split(&grid)?;
        let misses = measure(&axes, &nodes, &checks, plan)?;
        let mendable = misses.iter().filter(|miss| grid.mendable(miss));
        let worst = mendable.map(|miss| miss.error).fold(0.0, f64::max);
        let limit = if spread { 1.0 } else { MARGIN };
        let halved = grid.halve(&misses, limit * plan.interpolation, plan);
        let shortfall = |reason| Error::ToleranceNotReached {
            measured: worst,
            asked: plan.interpolation,
            nodes: axes.node_count(),
            reason,
        };
        let ended = match halved {
            Halved::Some => None,
            Halved::Nothing | Halved::Noise if !spread => {
                spread = true;
                continue;
            }
            Halved::Nothing => Some(None),
            Halved::Noise => Some(Some(shortfall(
                "where it is missed the solver's own error is as large: ask more of the solver (accuracy.p_max)",
            ))),
            Halved::Limit(reason) => Some(Some(shortfall(reason))),
        };
        if let Some(shortfall) = ended {
            return Ok(Refinement {
                axes,
                nodes,
                checks,
                shortfall,
            });
        }
    }
}

/// Every solve so far, in the order they were asked for.
#[derive(Default)]
struct Known {
    solved: HashMap<Key, Solved>,
    order: Vec<Point>,
}

impl Known {
    fn solve<E>(&mut self, points: &[Point], solve: &mut SolveBatch<E>) -> Result<(), E> {
        let mut new: Vec<Point> = Vec::new();
        let mut asked = std::collections::HashSet::new();
        for point in points {
            let key = key(point);
            if !self.solved.contains_key(&key) && asked.insert(key) {
                new.push(*point);
            }
        }
        if new.is_empty() {
            return Ok(());
        }
        for (point, solved) in new.iter().zip(solve(&new)?) {
            self.solved.insert(key(point), solved);
            self.order.push(*point);
        }
        Ok(())
    }

    /// The grid's nodes, and everything else as checks.
    fn split(&self, grid: &Grid) -> Result<(Axes, Vec<Solved>, Vec<Check>), Error> {
        let axes = grid.axes()?;
        let points = axes.points();
        let nodes = points
            .iter()
            .map(|point| self.solved[&key(point)])
            .collect();
        let taken: std::collections::HashSet<Key> = points.iter().map(key).collect();
        let checks = self
            .order
            .iter()
            .filter(|point| !taken.contains(&key(point)))
            .map(|point| Check {
                point: *point,
                solved: self.solved[&key(point)],
            })
            .collect();
        Ok((axes, nodes, checks))
    }
}

fn key(point: &Point) -> Key {
    [
        point.fz.to_bits(),
        // One zero, whatever its sign.
        (point.curvature + 0.0).to_bits(),
        point.rocker_radius.unwrap_or(0.0).to_bits(),
    ]
}

/// A check and the largest relative error of the peak pressure there over the modes asked for.
struct Miss {
    point: [f64; 3],
    error: f64,
    /// The solver's own relative error: of the check and the worst of the nodes around it.
    noise: f64,
}

fn measure(
    axes: &Axes,
    nodes: &[Solved],
    checks: &[Check],
    plan: &Plan,
) -> Result<Vec<Miss>, Error> {
    let table = Table::new(axes.clone(), nodes.to_vec(), Vec::new())?;
    let mut lookups: HashMap<(u64, Mode), Lookup> = HashMap::new();
    let mut misses = Vec::with_capacity(checks.len());
    let relative = |solved: &Solved| solved.p_max_error.abs() / solved.p_max.abs();
    for check in checks {
        let around = axes.around(&check.point);
        let at_nodes = around.map(|node| relative(&nodes[node]));
        let noise = relative(&check.solved) + at_nodes.fold(0.0, f64::max);
        let radius = check.point.rocker_radius;
        let mut error = 0.0f64;
        for &mode in &plan.modes {
            let name = (radius.unwrap_or(0.0).to_bits(), mode);
            if let std::collections::hash_map::Entry::Vacant(entry) = lookups.entry(name) {
                entry.insert(Lookup::with_rocker(&table, Quantity::PMax, mode, radius)?);
            }
            error = error.max(relative_error(&lookups[&name], check, Quantity::PMax));
        }
        misses.push(Miss {
            point: [check.point.fz, check.point.curvature, radius.unwrap_or(0.0)],
            error,
            noise,
        });
    }
    Ok(misses)
}

enum Halved {
    Some,
    Nothing,
    Noise,
    Limit(&'static str),
}

/// The axis as the sweep divides it: logarithms of forces and radii, plain curvatures.
pub(crate) fn scaled(axis: usize, value: f64) -> f64 {
    if axis == 1 { value } else { value.ln() }
}

fn middle(axis: usize, low: f64, high: f64) -> f64 {
    if axis == 1 {
        0.5 * (low + high)
    } else {
        (low * high).sqrt()
    }
}

impl Grid {
    fn start(plan: &Plan) -> Result<Self, Error> {
        let spacings = [
            Some(&plan.fz),
            Some(&plan.curvature),
            plan.rocker_radius.as_ref(),
        ];
        let names = ["fz_n", "curvature_1pm", "rocker_radius_m"];
        let mut values: [Vec<f64>; 3] = Default::default();
        let mut refined = [false; 3];
        for (axis, spacing) in spacings.into_iter().enumerate() {
            values[axis] = match spacing {
                None => vec![0.0],
                Some(Spacing::Values(values)) => values.clone(),
                Some(&Spacing::Range { from, to }) => {
                    // The ends are checked before anything is computed from them.
                    let wrong = |index, value, expected| Error::AxisValue {
                        axis: names[axis],
                        index,
                        value,
                        expected,
                    };
                    let usable = |v: f64| v.is_finite() && (axis == 1 || v > 0.0);
                    for (index, value) in [from, to].into_iter().enumerate() {
                        if !usable(value) {
                            let expected = "a finite number, positive for forces and radii";
                            return Err(wrong(index, value, expected));
                        }
                    }
                    if to <= from {
                        return Err(wrong(1, to, "a value above where the range starts"));
                    }
                    refined[axis] = true;
                    let centre = middle(axis, from, to);
                    let (low, high) = (middle(axis, from, centre), middle(axis, centre, to));
                    vec![from, low, centre, high, to]
                }
            };
        }
        Ok(Grid {
            values,
            refined,
            has_rocker: plan.rocker_radius.is_some(),
        })
    }

    fn axes(&self) -> Result<Axes, Error> {
        let [fz, curvature, rocker] = self.values.clone();
        Axes::new(fz, curvature, self.has_rocker.then_some(rocker))
    }

    fn point(&self, [fz, curvature, radius]: [f64; 3]) -> Point {
        Point {
            fz,
            curvature,
            rocker_radius: self.has_rocker.then_some(radius),
        }
    }

    /// Middles of the intervals of every refined axis, on every other grid line.
    fn middles(&self) -> Vec<Point> {
        let sparse = |axis: usize| {
            let values = &self.values[axis];
            let last = values.len() - 1;
            let kept = move |i: &usize| i.is_multiple_of(2) || *i == last;
            (0..=last)
                .filter(kept)
                .map(|i| values[i])
                .collect::<Vec<_>>()
        };
        let mut points = Vec::new();
        for axis in (0..3).filter(|&axis| self.refined[axis]) {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for pair in self.values[axis].windows(2) {
                let mut at = [0.0; 3];
                at[axis] = middle(axis, pair[0], pair[1]);
                for &vb in &sparse(b) {
                    for &vc in &sparse(c) {
                        at[b] = vb;
                        at[c] = vc;
                        points.push(self.point(at));
                    }
                }
            }
        }
        points
    }

    /// Spread points; where an axis is given by its values, every other point lies on one of them, so that it
    /// measures the refined axes alone.
    fn spread(&self, count: usize) -> Vec<Point> {
        let points = spread(&self.values, count).into_iter().enumerate();
        points
            .map(|(n, mut at)| {
                for axis in (0..3).filter(|&axis| !self.refined[axis] && n.is_multiple_of(2)) {
                    let values = &self.values[axis];
                    at[axis] = values[values
                        .partition_point(|&v| v < at[axis])
                        .min(values.len() - 1)];
                }
                self.point(at)
            })
            .collect()
    }

    /// Whether refinement can mend a miss here: not between given values.
    fn mendable(&self, miss: &Miss) -> bool {
        (0..3).all(|axis| self.refined[axis] || self.values[axis].contains(&miss.point[axis]))
    }

    /// Halves the interval around every miss above `limit`, along the axis whose middles are missed most.
    fn halve(&mut self, misses: &[Miss], limit: f64, plan: &Plan) -> Halved {
        // Largest error at the middle of each interval of each axis.
        let mut at_middle: [Vec<f64>; 3] =
            std::array::from_fn(|axis| vec![0.0; self.values[axis].len().saturating_sub(1)]);
        for miss in misses {
            for axis in (0..3).filter(|&axis| self.refined[axis]) {
                let k = self.interval(axis, miss.point[axis]);
                let pair = &self.values[axis][k..k + 2];
                if miss.point[axis] == middle(axis, pair[0], pair[1]) && self.mendable(miss) {
                    at_middle[axis][k] = f64::max(at_middle[axis][k], miss.error);
                }
            }
        }
        let mut marked: [Vec<usize>; 3] = Default::default();
        let mut too_small = false;
        let mut too_noisy = false;
        for miss in misses {
            if miss.error <= limit || !self.mendable(miss) {
                continue;
            }
            // Halving on account of the solver's error would never end.
            if miss.error <= miss.noise {
                too_noisy = true;
                continue;
            }
            let mut best: Option<(f64, usize, usize)> = None;
            for axis in (0..3).filter(|&axis| self.refined[axis]) {
                let k = self.interval(axis, miss.point[axis]);
                let inside = !self.values[axis].contains(&miss.point[axis]);
                if inside && self.divisible(axis, k, plan.smallest_interval) {
                    let error = at_middle[axis][k];
                    if best.is_none_or(|(most, _, _)| error > most) {
                        best = Some((error, axis, k));
                    }
                }
            }
            match best {
                Some((_, axis, k)) => marked[axis].push(k),
                None => too_small = true,
            }
        }
        let mut grown = self.values.clone();
        for axis in 0..3 {
            marked[axis].sort_unstable();
            marked[axis].dedup();
            for &k in &marked[axis] {
                let pair = &self.values[axis][k..k + 2];
                grown[axis].push(middle(axis, pair[0], pair[1]));
            }
            grown[axis].sort_by(f64::total_cmp);
        }
        if marked.iter().all(Vec::is_empty) {
            return if too_noisy {
                Halved::Noise
            } else if too_small {
                Halved::Limit("where it is missed the intervals are as small as they may be")
            } else {
                Halved::Nothing
            };
        }
        let nodes: usize = grown.iter().map(Vec::len).product();
        if nodes > plan.max_nodes || grown.iter().any(|axis| axis.len() > MAX_AXIS) {
            return Halved::Limit("more nodes than the table may have");
        }
        self.values = grown;
        Halved::Some
    }

    fn interval(&self, axis: usize, value: f64) -> usize {
        let values = &self.values[axis];
        values
            .partition_point(|&v| v <= value)
            .clamp(1, values.len() - 1)
            - 1
    }

    /// Whether halves of interval `k` are no smaller than `smallest`, a part of the axis.
    fn divisible(&self, axis: usize, k: usize, smallest: f64) -> bool {
        let values = &self.values[axis];
        let at = |i: usize| scaled(axis, values[i]);
        let part = (at(k + 1) - at(k)) / (at(values.len() - 1) - at(0));
        part > 1.5 * smallest
    }
}

/// `count` points spread evenly between the ends of the axes: the R2 sequence (M. Roberts, The unreasonable
/// effectiveness of quasirandom sequences, 2018) in the scaled axes.
pub(crate) fn spread(values: &[Vec<f64>; 3], count: usize) -> Vec<[f64; 3]> {
    // 1/g, 1/g^2, 1/g^3 for the root g of g^4 = g + 1.
    const STEPS: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
    ];
    (1..=count)
        .map(|n| {
            std::array::from_fn(|axis| {
                let (first, last) = (values[axis][0], values[axis][values[axis].len() - 1]);
                if first == last {
                    return first;
                }
                let t = (0.5 + n as f64 * STEPS[axis]).fract();
                if axis == 1 {
                    first + t * (last - first)
                } else {
                    first * (last / first).powf(t)
                }
            })
        })
        .collect()
}
