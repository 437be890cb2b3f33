//! Halving the intervals where the interpolation misses.

use crate::sweep::grid::{Grid, middle};
use crate::sweep::misses::Miss;
use crate::sweep::plan::{AXES, Plan};
use crate::table::axes::MAX_AXIS;

/// What halving did, or why it could not.
pub(crate) enum Halved {
    Some,
    Nothing,
    Noise,
    Limit(&'static str),
}

/// Halves the interval around every miss above `limit`, along the axis whose middles are missed most.
pub(crate) fn halve(grid: &mut Grid, misses: &[Miss], limit: f64, plan: &Plan) -> Halved {
    // Largest error at the middle of each interval of each axis.
    let mut at_middle: [Vec<f64>; AXES] =
        std::array::from_fn(|axis| vec![0.0; grid.values[axis].len().saturating_sub(1)]);
    for miss in misses {
        for axis in (0..AXES).filter(|&axis| grid.refined[axis]) {
            let k = grid.interval(axis, miss.place[axis]);
            let pair = &grid.values[axis][k..k + 2];
            if miss.place[axis] == middle(axis, pair[0], pair[1]) && miss.mendable(grid) {
                at_middle[axis][k] = f64::max(at_middle[axis][k], miss.error);
            }
        }
    }
    let mut marked: [Vec<usize>; AXES] = Default::default();
    let mut too_small = false;
    let mut too_noisy = false;
    for miss in misses {
        if miss.error <= limit || !miss.mendable(grid) {
            continue;
        }
        // Halving on account of the solver's error would never end.
        if miss.error <= miss.noise {
            too_noisy = true;
            continue;
        }
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in (0..AXES).filter(|&axis| grid.refined[axis]) {
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
            Some((_, axis, k)) => marked[axis].push(k),
            None => too_small = true,
        }
    }
    let mut grown = grid.values.clone();
    for axis in 0..AXES {
        marked[axis].sort_unstable();
        marked[axis].dedup();
        for &k in &marked[axis] {
            let pair = &grid.values[axis][k..k + 2];
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
    grid.values = grown;
    Halved::Some
}
