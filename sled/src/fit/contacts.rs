//! Where something other than ice and air pushes.

use rayon::prelude::*;

use crate::model::vehicle::Vehicle;
use crate::motion::one_track::{forward, resultant};
use crate::signals::prepare::Prepared;

/// Samples at which something other than ice and air pushes, one mark a sample and run.
///
/// The residual of the lateral force at the centre of gravity, model against measurement, beyond six robust standard
/// deviations (1.4826 times its median magnitude over all runs), and a fifth of a second around it. Sensor noise reaches six
/// deviations less than once in 10^8 samples; a wall contact of a few hundred newtons always does.
pub fn find_contacts(runs: &[Prepared], vehicle: &Vehicle) -> Vec<Vec<bool>> {
    let residuals: Vec<Vec<f64>> = runs
        .par_iter()
        .map(|run| {
            let vehicle = &vehicle.on_run(&run.entry.track, &run.entry.conditions);
            run.states
                .iter()
                .zip(&run.motions)
                .map(|(state, motion)| {
                    let model = resultant(&vehicle.sled, state, &forward(vehicle, state)).fy_n;
                    (vehicle.sled.mass_kg * motion.accel_mps2[1] - model).abs()
                })
                .collect()
        })
        .collect();
    let mut sizes: Vec<f64> = residuals.iter().flatten().copied().collect();
    if sizes.is_empty() {
        return Vec::new();
    }
    let middle = sizes.len() / 2;
    let limit = 6.0 * 1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    residuals
        .iter()
        .zip(runs)
        .map(|(residual, run)| {
            let around = (0.2 / run.dt_s).round() as usize;
            let mut marked = vec![false; residual.len()];
            for piece in &run.pieces {
                for i in piece.clone().filter(|i| residual[*i] > limit) {
                    let end = (i + around + 1).min(piece.end);
                    marked[i.saturating_sub(around).max(piece.start)..end].fill(true);
                }
            }
            marked
        })
        .collect()
}
