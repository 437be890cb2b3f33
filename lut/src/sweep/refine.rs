//! Refinement of breakpoints where the interpolation error is largest.
//!
//! Each round solves the nodes and the midpoint of every interval of a refined axis, on every
//! second grid line. An interval is halved if the error at its midpoint exceeds [`MARGIN`] times
//! the requested error; the midpoints become nodes. If no interval is halved, quasi-random points
//! (Roberts' R2 sequence) are solved and measured. An error above the request halves the interval
//! around the point, unless the solver's own error is as large. The sweep ends when the
//! interpolation error at every solve between nodes is within the request. Axes with given values
//! are not refined; errors between these values are measured but not reduced.

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

/// Largest error at the midpoint of an interval, as a fraction of the requested error: between the
/// checks it may be larger.
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
        let errors = measure(&grid, &axes, &nodes, &checked, plan)?;
        let limit = if spread { 1.0 } else { MARGIN };
        let halved = halve(&mut grid, &errors, limit * plan.interpolation, plan);
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
            measured: errors.iter().map(|check| check.error).fold(0.0, f64::max),
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

    /// Figures at the nodes of the grid, and all other solves as checks with their places.
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

/// Bits of the coordinates, with -0 as 0.
fn key(place: &Place) -> Key {
    place.map(|value| (value + 0.0).to_bits())
}

/// A check with the largest relative interpolation error of the judged quantity over the plan's
/// modes.
struct CheckError {
    pub place: Place,
    pub error: f64,
    /// Relative error of the solver: at the check plus the largest at the nodes around it.
    pub noise: f64,
}

/// Errors at the checks of a table with these nodes. Checks between given values are omitted,
/// since refinement cannot reduce their errors.
fn measure(
    grid: &Grid,
    axes: &Axes,
    nodes: &[Figures],
    checks: &[(Place, Solve)],
    plan: &Plan,
) -> Result<Vec<CheckError>, Error> {
    let table = Table::new(axes.clone(), nodes, Vec::new())?;
    let mut interpolators: HashMap<(u64, Mode), Interpolator> = HashMap::new();
    let mut errors = Vec::with_capacity(checks.len());
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
        errors.push(CheckError {
            place: *place,
            error,
            noise,
        });
    }
    Ok(errors)
}

const NOISE: &str = "where the interpolation error is too large, the solver's own error is as large: request a more accurate solver (accuracy.p_max)";
const TOO_SMALL: &str =
    "where the interpolation error is too large, the intervals are as small as allowed";

/// Largest error at the midpoint of each interval of each axis.
fn errors_at_middles(grid: &Grid, errors: &[CheckError]) -> [Vec<f64>; KINDS] {
    let mut at_middle: [Vec<f64>; KINDS] =
        std::array::from_fn(|axis| vec![0.0; grid.values[axis].len().saturating_sub(1)]);
    for check in errors {
        for axis in (0..KINDS).filter(|&axis| grid.refined[axis]) {
            let k = grid.interval(axis, check.place[axis]);
            let pair = &grid.values[axis][k..k + 2];
            if check.place[axis] == middle(axis, pair[0], pair[1]) {
                at_middle[axis][k] = f64::max(at_middle[axis][k], check.error);
            }
        }
    }
    at_middle
}

/// Halves the interval around every check with an error above `limit`, along the axis with the
/// largest error at the midpoint of its interval. Returns whether any was halved.
///
/// # Errors
/// The reason why no interval can be halved.
fn halve(
    grid: &mut Grid,
    errors: &[CheckError],
    limit: f64,
    plan: &Plan,
) -> Result<bool, &'static str> {
    let at_middle = errors_at_middles(grid, errors);
    let mut marked: [BTreeSet<usize>; KINDS] = Default::default();
    let (mut too_small, mut too_noisy) = (false, false);
    for check in errors {
        if check.error <= limit {
            continue;
        }
        // Halving because of the solver's error would not end.
        if check.error <= check.noise {
            too_noisy = true;
            continue;
        }
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in (0..KINDS).filter(|&axis| grid.refined[axis]) {
            let k = grid.interval(axis, check.place[axis]);
            let inside = !grid.values[axis].contains(&check.place[axis]);
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
        let small = if too_small { Err(TOO_SMALL) } else { Ok(false) };
        return if too_noisy { Err(NOISE) } else { small };
    }
    let nodes: usize = grown.iter().map(Vec::len).product();
    if nodes > plan.max_nodes || grown.iter().any(|axis| axis.len() > MAX_AXIS) {
        return Err("more nodes than the table may have");
    }
    grid.values = grown;
    Ok(true)
}
