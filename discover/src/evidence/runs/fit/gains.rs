//! What a balance takes of the acceleration that it is about: a model that counts less of a noisy measurement leaves less, and explains
//! nothing by it.
//!
//! With noise of known deviations in the acceleration a and in what the forces are made of, and the true motion unknown, the criterion of a
//! fit is that of the residual r over the deviation that the noise gives it with this model,
//!
//! ```text
//! sum_c n_c (ln(rms_c) - ln(v_c) / 2)        v = (dr/da)^2 var(a) + var(forces)
//! ```
//!
//! of which the part that a takes, with its share w of v, counts here: `ln(v) / 2` changes by `w ln|dr/da|`. What a model makes of noise in
//! the forces is taken off by corrected scores.
//!
//! Source: R. J. Carroll and others, Measurement Error in Nonlinear Models (2006), section 3.4: orthogonal regression with known ratios
//! of the variances.

use rayon::prelude::*;

use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{BALANCES, CHANNELS, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Means over the runs of `w ln |dr/da|`, by channel in use.
pub fn log_gains(model: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS]) -> Vec<f64> {
    let each: Vec<[f64; BALANCES]> = frames.par_iter().map(|f| log_gains_of(model, f)).collect();
    let rows = frames.iter().map(|frame| frame.row_count() as f64);
    let all: f64 = rows.clone().sum();
    (0..BALANCES)
        .filter(|c| used[*c])
        .map(|c| {
            let of_runs = each.iter().zip(rows.clone());
            of_runs.map(|(mean, n)| n * mean[c]).sum::<f64>() / all.max(1.0)
        })
        .collect()
}

/// Means over one run of `w ln |dr/da|`, by balance.
pub fn log_gains_of(model: &ResidualModel, frame: &Frame) -> [f64; BALANCES] {
    /// Samples of a run: masses and scales are the same all along, and what a bent sensor reads is not by much.
    const SAMPLES: usize = 16;
    let on_run = ModelOnRun::new(model, frame);
    let stride = frame.len().div_ceil(SAMPLES);
    let taken: Vec<usize> = frame.samples().step_by(stride.max(1)).collect();
    let mut means = [0.0; BALANCES];
    for i in &taken {
        let own = on_run.gains(*i).into_iter().zip(model.own_noise);
        for (mean, (gain, share)) in means.iter_mut().zip(own) {
            *mean += share * gain.abs().max(1e-300).ln() / taken.len() as f64;
        }
    }
    means
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
