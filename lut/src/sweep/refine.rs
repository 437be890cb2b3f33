//! Placing breakpoints where the interpolation is worst.
//!
//! Each round solves the nodes and, on every interval of an axis to be refined, its middle on every
//! other grid line. An interval whose error there is above [`MARGIN`] of the request is halved; the
//! solves just made become nodes. When no interval is, points spread evenly over the table
//! (Roberts' R2 sequence) are solved and measured: a miss halves the interval around it, unless the
//! solver's own error is as large as the miss. The sweep ends when every solve that is no node is
//! met within the request. Axes given by their values stay as they are, and what the interpolation
//! misses between those values is measured but not reduced.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};

use crate::axes::{Axes, KINDS, MAX_AXIS, Point};
use crate::error::Error;
use crate::interpolator::{Interpolator, Mode};
use crate::quantity::{Figures, Quantity};
use crate::solve::Solve;
use crate::sweep::grid::{Grid, Place, middle};
use crate::sweep::plan::Plan;
use crate::sweep::{SolveBatch, SweepResult};
use crate::table::{Table, relative_error};

/// Part of the requested error that an interval's middle may have: between the checks it may be
/// larger.
const MARGIN: f64 = 0.8;

/// The table of a plan whose axes are refined.
pub(crate) fn refine<E: From<Error>>(
    plan: &Plan,
    solve: &mut SolveBatch<E>,
) -> Result<SweepResult, E> {
    let mut grid = Grid::start(plan)?;
    let mut solved = Solved::default();
    let mut spread = false;
    loop {
        let axes = grid.axes()?;
        let mut places = grid.nodes();
        places.extend(grid.middles());
        if spread {
            places.extend(grid.spread(plan.checks));
        }
        solved.solve(&grid, &places, solve)?;
        let (nodes, checked) = solved.split(&grid);
        let checks: Vec<Solve> = checked.iter().map(|(_, check)| *check).collect();
        let misses = measure(&grid, &axes, &nodes, &checked, plan)?;
        let limit = if spread { 1.0 } else { MARGIN };
        let halved = halve(&mut grid, &misses, limit * plan.interpolation, plan);
        match halved {
            Ok(true) => continue,
            Ok(false) | Err(NOISE) if !spread => {
                spread = true;
                continue;
            }
            _ => {}
        }
        let shortfall = halved.err().map(|reason| Error::ToleranceNotReached {
            quantity: Quantity::judged(nodes[0].is_sliding()).name(),
            measured: misses.iter().map(|miss| miss.error).fold(0.0, f64::max),
            requested: plan.interpolation,
            nodes: axes.node_count(),
            reason,
        });
        let mut table = Table::new(axes, &nodes, checks)?;
        table.interpolation_requested = Some(plan.interpolation);
        return Ok(SweepResult { table, shortfall });
    }
}

type Key = [u64; KINDS];

/// Every solve so far, in the order of the requests.
#[derive(Default)]
struct Solved {
    solved: HashMap<Key, Figures>,
    order: Vec<Place>,
}

impl Solved {
    pub fn solve<E>(
        &mut self,
        grid: &Grid,
        places: &[Place],
        solve: &mut SolveBatch<E>,
    ) -> Result<(), E> {
        let mut requested = HashSet::new();
        let unknown =
            |place: &&Place| !self.solved.contains_key(&key(place)) && requested.insert(key(place));
        let new: Vec<Place> = places.iter().filter(unknown).copied().collect();
        if new.is_empty() {
            return Ok(());
        }
        let points: Vec<Point> = new.iter().map(|&place| grid.point(place)).collect();
        for (place, solved) in new.into_iter().zip(solve(&points)?) {
            self.solved.insert(key(&place), solved);
            self.order.push(place);
        }
        Ok(())
    }

    /// The grid's nodes, and everything else as checks with their places.
    pub fn split(&self, grid: &Grid) -> (Vec<Figures>, Vec<(Place, Solve)>) {
        let places = grid.nodes();
        let figures = |place: &Place| self.solved[&key(place)];
        let nodes = places.iter().map(figures).collect();
        let taken: HashSet<Key> = places.iter().map(key).collect();
        let others = self.order.iter();
        let others = others.filter(|place| !taken.contains(&key(place)));
        let checks = others.map(|place| {
            let (point, figures) = (grid.point(*place), figures(place));
            (*place, Solve { point, figures })
        });
        (nodes, checks.collect())
    }
}

/// One zero, whatever its sign.
fn key(place: &Place) -> Key {
    place.map(|value| (value + 0.0).to_bits())
}

/// A check and the largest relative error of the judged quantity there over the plan's modes.
struct Miss {
    pub place: Place,
    pub error: f64,
    /// The solver's own relative error: of the check and the worst of the nodes around it.
    pub noise: f64,
}

/// The misses at the checks of a table with these nodes, but for those between given values, which
/// refinement cannot reduce.
fn measure(
    grid: &Grid,
    axes: &Axes,
    nodes: &[Figures],
    checks: &[(Place, Solve)],
    plan: &Plan,
) -> Result<Vec<Miss>, Error> {
    let table = Table::new(axes.clone(), nodes, Vec::new())?;
    let mut interpolators: HashMap<(u64, Mode), Interpolator> = HashMap::new();
    let mut misses = Vec::with_capacity(checks.len());
    let judged = table.judged();
    let reducible = |place: &Place| {
        (0..KINDS).all(|axis| grid.refined[axis] || grid.values[axis].contains(&place[axis]))
    };
    for (place, check) in checks.iter().filter(|(place, _)| reducible(place)) {
        let around = axes.around(&check.point);
        let at_nodes = around.into_iter().map(|node| nodes[node].relative_error());
        let noise = check.figures.relative_error() + at_nodes.fold(0.0, f64::max);
        let radius = check.point.rocker_radius;
        let mut error = 0.0f64;
        for &mode in &plan.modes {
            let name = (radius.unwrap_or(0.0).to_bits(), mode);
            if let Entry::Vacant(entry) = interpolators.entry(name) {
                entry.insert(Interpolator::new(&table, judged, mode, radius)?);
            }
            let missed = relative_error(&interpolators[&name], check, judged);
            error = error.max(missed.unwrap_or(0.0));
        }
        misses.push(Miss {
            place: *place,
            error,
            noise,
        });
    }
    Ok(misses)
}

const NOISE: &str = "where the interpolation misses, the solver's own error is as large: request more of the solver (accuracy.p_max)";
const SMALLEST: &str = "where the interpolation misses, the intervals are as small as they may be";

/// Halves the interval around every miss above `limit`, along the axis whose middles are missed
/// most; whether there is one.
///
/// # Errors
/// Why no interval can be halved.
fn halve(grid: &mut Grid, misses: &[Miss], limit: f64, plan: &Plan) -> Result<bool, &'static str> {
    // Largest error at the middle of each interval of each axis.
    let mut at_middle: [Vec<f64>; KINDS] =
        std::array::from_fn(|axis| vec![0.0; grid.values[axis].len().saturating_sub(1)]);
    for miss in misses {
        for axis in (0..KINDS).filter(|&axis| grid.refined[axis]) {
            let k = grid.interval(axis, miss.place[axis]);
            let pair = &grid.values[axis][k..k + 2];
            if miss.place[axis] == middle(axis, pair[0], pair[1]) {
                at_middle[axis][k] = f64::max(at_middle[axis][k], miss.error);
            }
        }
    }
    let mut marked: [BTreeSet<usize>; KINDS] = Default::default();
    let (mut too_small, mut too_noisy) = (false, false);
    for miss in misses {
        if miss.error <= limit {
            continue;
        }
        // Halving because of the solver's error would never end.
        if miss.error <= miss.noise {
            too_noisy = true;
            continue;
        }
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in (0..KINDS).filter(|&axis| grid.refined[axis]) {
            let k = grid.interval(axis, miss.place[axis]);
            let inside = !grid.values[axis].contains(&miss.place[axis]);
            if inside && grid.divisible(axis, k, plan.smallest_interval) {
                let error = at_middle[axis][k];
                if best.is_none_or(|(most, _, _)| error > most) {
                    best = Some((error, axis, k));
                }
            }
        }
        match best {
            Some((_, axis, k)) => _ = marked[axis].insert(k),
            None => too_small = true,
        }
    }
    let mut grown = grid.values.clone();
    for axis in 0..KINDS {
        for &k in &marked[axis] {
            let pair = &grid.values[axis][k..k + 2];
            grown[axis].push(middle(axis, pair[0], pair[1]));
        }
        grown[axis].sort_by(f64::total_cmp);
    }
    if marked.iter().all(BTreeSet::is_empty) {
        let small = if too_small { Err(SMALLEST) } else { Ok(false) };
        return if too_noisy { Err(NOISE) } else { small };
    }
    let nodes: usize = grown.iter().map(Vec::len).product();
    if nodes > plan.max_nodes || grown.iter().any(|axis| axis.len() > MAX_AXIS) {
        return Err("more nodes than the table may have");
    }
    grid.values = grown;
    Ok(true)
}
