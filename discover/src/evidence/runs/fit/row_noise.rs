//! What the sensors' noise makes of a balance's residual by a model: one that counts less of what is noisy leaves less, and explains
//! nothing by it.
//!
//! The true motion is unknown, and noise of known deviations lies in the accelerations as in what the forces are made of. With v the
//! variance that it gives the residual r by this model, the criterion of a fit is that of r over the root of v, whose size is left open:
//!
//! ```text
//! sum_c n_c (ln(rms_c) - ln(v_c) / 2)
//! ```
//!
//! Half masses, forces and inertias leave half the residual, and half its noise. v is found from a piece of each run with noise of both
//! signs upon it, the same for every model.
//!
//! Source: R. J. Carroll, D. Ruppert, L. A. Stefanski, C. M. Crainiceanu, Measurement Error in Nonlinear Models (2006), section 3.4.

use rayon::prelude::*;

use crate::evidence::runs::model::residual_model::{BALANCES, CHANNELS, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Means over the runs of `ln(v) / 2`, by channel in use.
pub fn log_noise(model: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS]) -> Vec<f64> {
    let each: Vec<[f64; BALANCES]> = frames.par_iter().map(|f| log_noise_of(model, f)).collect();
    let rows = frames.iter().map(|frame| frame.row_count() as f64);
    let all: f64 = rows.clone().sum();
    (0..BALANCES)
        .filter(|c| used[*c])
        .map(|c| {
            let of_runs = each.iter().zip(rows.clone());
            of_runs.map(|(log, n)| n * log[c]).sum::<f64>() / all.max(1.0)
        })
        .collect()
}

/// `ln(v) / 2` of one run, by balance; 0 where nothing tells.
pub fn log_noise_of(model: &ResidualModel, frame: &Frame) -> [f64; BALANCES] {
    let Some(noisy) = &frame.noisy else {
        return [0.0; BALANCES];
    };
    let [plus, minus] = noisy.each_ref().map(|frame| model.residuals(frame));
    std::array::from_fn(|c| {
        let rows = plus[c].iter().zip(&minus[c]);
        let squares: f64 = rows.map(|(p, m)| (0.5 * (p - m)).powi(2)).sum();
        match plus[c].len() {
            0 => 0.0,
            n => 0.5 * (squares / n as f64).max(1e-300).ln(),
        }
    })
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
        let noise = log_noise(&moved, frames, used);
        noise
            .iter()
            .zip(own)
            .map(|(log, own)| (log - own) / STEP)
            .collect()
    };
    model.free().into_iter().map(of).collect()
}
