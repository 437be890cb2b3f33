//! Placing breakpoints where the interpolation is worst.
//!
//! Each round solves the nodes and, on every interval of an axis to be refined, its middle on every other grid
//! line. An interval whose error there is above [`MARGIN`] of what was asked is halved; the solves just made become nodes.
//! When no interval is, points spread evenly over the table (Roberts' R2 sequence) are solved and measured: a miss halves
//! the interval around it, unless the solver's own error is as large as the miss. The sweep ends when every solve that is
//! no node is met within what was asked. Axes given by their values stay as they are, and what the interpolation misses
//! between those values is measured but not mended.

use crate::error::Error;
use crate::sweep::grid::Grid;
use crate::sweep::halve::{Halved, halve};
use crate::sweep::known::Known;
use crate::sweep::misses::measure;
use crate::sweep::plan::{Plan, SolveBatch};
use crate::table::axes::Axes;
use crate::table::nodes::Check;
use crate::table::quantity::Quantity;
use crate::table::solved::Solved;

/// Part of the asked error that an interval's middle may have: between the checks it may be larger.
const MARGIN: f64 = 0.8;

pub(crate) struct Refinement {
    pub axes: Axes,
    pub nodes: Vec<Solved>,
    pub checks: Vec<Check>,
    pub shortfall: Option<Error>,
}

pub(crate) fn refine<E: From<Error>>(
    plan: &Plan,
    solve: &mut SolveBatch<E>,
) -> Result<Refinement, E> {
    let mut grid = Grid::start(plan)?;
    let mut known: Known = Known::default();
    let mut spread = false;
    loop {
        let axes = grid.axes()?;
        let mut places = grid.nodes();
        places.extend(grid.middles());
        if spread {
            places.extend(grid.spread(plan.checks));
        }
        known.solve(&grid, &places, solve)?;
        let (nodes, checked) = known.split(&grid);
        let checks: Vec<Check> = checked.iter().map(|(_, check)| *check).collect();
        let misses = measure(&axes, &nodes, &checked, plan)?;
        let mendable = misses.iter().filter(|miss| miss.mendable(&grid));
        let worst = mendable.map(|miss| miss.error).fold(0.0, f64::max);
        let limit = if spread { 1.0 } else { MARGIN };
        let halved = halve(&mut grid, &misses, limit * plan.interpolation, plan);
        let shortfall = |reason| Error::ToleranceNotReached {
            quantity: Quantity::judged(nodes[0].sliding.is_some()).name(),
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
