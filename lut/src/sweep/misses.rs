//! What the interpolation misses at the checks.

use std::collections::HashMap;

use crate::error::Error;
use crate::sweep::grid::{Grid, Place};
use crate::sweep::plan::{AXES, Plan};
use crate::table::axes::Axes;
use crate::table::layered::Layered;
use crate::table::measure::relative_error;
use crate::table::mode::Mode;
use crate::table::nodes::{Check, Table};
use crate::table::solved::Solved;

/// A check and the largest relative error of what is judged there over the modes asked for.
pub(crate) struct Miss {
    pub place: Place,
    pub error: f64,
    /// The solver's own relative error: of the check and the worst of the nodes around it.
    pub noise: f64,
}

impl Miss {
    /// Whether refinement can mend it: not between given values.
    pub fn mendable(&self, grid: &Grid) -> bool {
        (0..AXES).all(|axis| grid.refined[axis] || grid.values[axis].contains(&self.place[axis]))
    }
}

/// The misses at the checks of a table with these nodes.
pub(crate) fn measure(
    axes: &Axes,
    nodes: &[Solved],
    checks: &[(Place, Check)],
    plan: &Plan,
) -> Result<Vec<Miss>, Error> {
    let table = Table::new(axes.clone(), nodes.to_vec(), Vec::new())?;
    let mut lookups: HashMap<(u64, Mode), Layered> = HashMap::new();
    let mut misses = Vec::with_capacity(checks.len());
    let judged = table.judged();
    for (place, check) in checks {
        let around = axes.around(&check.point);
        let at_nodes = around.map(|node| nodes[node].relative_error());
        let noise = check.solved.relative_error() + at_nodes.fold(0.0, f64::max);
        let radius = check.point.rocker_radius;
        let mut error = 0.0f64;
        for &mode in &plan.modes {
            let name = (radius.unwrap_or(0.0).to_bits(), mode);
            if let std::collections::hash_map::Entry::Vacant(entry) = lookups.entry(name) {
                entry.insert(Layered::new(&table, judged, mode, radius)?);
            }
            let missed = relative_error(&lookups[&name], check, judged);
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
