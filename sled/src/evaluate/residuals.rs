//! What the balances leave of measured runs.

use rayon::prelude::*;

use crate::fit::own_contacts::with_own_contacts;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::{Balance, Left};
use crate::signals::prepare::Prepared;

/// What the balances leave of one run, one a state.
pub fn residuals(run: &Prepared, vehicle: &Vehicle) -> Vec<Left> {
    let vehicle = &with_own_contacts(run, vehicle);
    let instants = run.states.iter().zip(&run.motions);
    instants
        .map(|(state, motion)| {
            let at = Balance::new(&vehicle.sled, state, motion);
            at.left(&at.forces(vehicle, &at.laws(vehicle)))
        })
        .collect()
}

/// Root mean square of each balance over the samples; 0 where there are none.
pub fn root_mean_square(left: &[Left]) -> Left {
    let count = left.len().max(1) as f64;
    let rms =
        |of: fn(&Left) -> f64| (left.iter().map(|l| of(l).powi(2)).sum::<f64>() / count).sqrt();
    Left {
        along_n: rms(|l| l.along_n),
        side_n: rms(|l| l.side_n),
        yaw_nm: rms(|l| l.yaw_nm),
    }
}

/// [`root_mean_square`] of what the balances leave of all runs, in parallel.
pub fn balances_left(runs: &[Prepared], vehicle: &Vehicle) -> Left {
    let each: Vec<Vec<Left>> = runs.par_iter().map(|run| residuals(run, vehicle)).collect();
    root_mean_square(&each.concat())
}
