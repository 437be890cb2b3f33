//! What a balance takes of the acceleration that it is about: a model that counts less of what was measured leaves less, and
//! explains nothing by it.
//!
//! With the density of what was measured, not of what is left, the criterion of a fit is
//!
//! ```text
//! p(a) = p(r(a)) |dr/da|        sum_c n_c (ln(rms_c) - mean ln |dr_c/da_c|)
//! ```

use rayon::prelude::*;

use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{BALANCES, CHANNELS, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Means over the runs of `ln |dr/da|`, by channel in use.
pub fn log_gains(model: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS]) -> Vec<f64> {
    /// Samples of a run: masses and scales are the same all along, and what a bent sensor reads is not by much.
    const SAMPLES: usize = 16;
    let of_run = |frame: &Frame| {
        let on_run = ModelOnRun::new(model, frame);
        let stride = frame.len().div_ceil(SAMPLES);
        let taken: Vec<usize> = frame.samples().step_by(stride.max(1)).collect();
        let rows = frame.row_count() as f64;
        let mut sums = [0.0; BALANCES];
        for i in &taken {
            for (sum, gain) in sums.iter_mut().zip(on_run.gains(*i)) {
                *sum += rows * gain.abs().max(1e-300).ln() / taken.len() as f64;
            }
        }
        (sums, rows)
    };
    let each: Vec<([f64; BALANCES], f64)> = frames.par_iter().map(of_run).collect();
    let rows: f64 = each.iter().map(|(_, rows)| rows).sum();
    (0..BALANCES)
        .filter(|c| used[*c])
        .map(|c| each.iter().map(|(sums, _)| sums[c]).sum::<f64>() / rows.max(1.0))
        .collect()
}

/// How they change with each fitted amplitude of the model's effects, in the unit in which it is fitted.
pub fn by_amplitudes(
    model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    own: &[f64],
) -> Vec<Vec<f64>> {
    const STEP: f64 = 0.01;
    let of = |(e, q): (usize, usize)| {
        let mut moved = model.clone();
        moved.effects.active[e].values[q] += STEP * model.scale(e, q);
        let gains = log_gains(&moved, frames, used);
        gains
            .iter()
            .zip(own)
            .map(|(g, own)| (g - own) / STEP)
            .collect()
    };
    model.free().into_iter().map(of).collect()
}
