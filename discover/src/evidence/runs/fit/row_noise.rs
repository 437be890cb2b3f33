//! What the sensors' noise makes of a balance's residual by a model: one that counts less of what is noisy leaves less, and explains
//! nothing by it.
//!
//! The true motion is unknown, and noise of known deviations lies in the accelerations a as in what the forces are made of. With v the
//! variance that it gives the residual r by this model, and b what the model lacks of the acceleration itself, the criterion of a fit is
//! that of r over the deviation to expect, whose size is left open:
//!
//! ```text
//! sum_c n_c (ln(rms_c) - ln(v_c + b_c (dr/da)^2) / 2)
//! ```
//!
//! Half masses, forces and inertias leave half the residual, and half of what is to be expected. v is found from a piece of each run with
//! noise of both signs upon it, the same for every model; b once, from what the base leaves.
//!
//! Source: R. J. Carroll, D. Ruppert, L. A. Stefanski, C. M. Crainiceanu, Measurement Error in Nonlinear Models (2006), section 3.4, where
//! b is the error in the equation.

use rayon::prelude::*;

use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{BALANCES, CHANNELS, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Means over the runs of `ln(v + b (dr/da)^2) / 2`, by channel in use.
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

/// `ln(v + b (dr/da)^2) / 2` of one run, by balance; 0 where nothing tells.
pub fn log_noise_of(model: &ResidualModel, frame: &Frame) -> [f64; BALANCES] {
    let of_channel = |(of, beyond): (OfNoise, f64)| {
        let expected = of.variance + beyond * of.gain * of.gain;
        if expected > 0.0 {
            0.5 * expected.ln()
        } else {
            0.0
        }
    };
    let mut each = of_noise(model, frame).into_iter().zip(model.beyond_noise);
    std::array::from_fn(|_| each.next().map_or(0.0, of_channel))
}

/// What each balance leaves beyond the noise, over the square of what it takes of its acceleration.
pub fn beyond_noise(model: &ResidualModel, frames: &[Frame]) -> [f64; BALANCES] {
    let of_run = |frame: &Frame| -> [[f64; 2]; BALANCES] {
        let (noise, left) = (of_noise(model, frame), model.residuals(frame));
        std::array::from_fn(|c| {
            let gain = (noise[c].gain * noise[c].gain).max(1e-300);
            let squares: f64 = left[c].iter().map(|r| r * r).sum();
            let n = left[c].len() as f64;
            [n, (squares - n * noise[c].variance) / gain]
        })
    };
    let each: Vec<[[f64; 2]; BALANCES]> = frames.par_iter().map(of_run).collect();
    std::array::from_fn(|c| {
        let [n, beyond] = [0, 1].map(|k| each.iter().map(|run| run[c][k]).sum::<f64>());
        (beyond / n.max(1.0)).max(0.0)
    })
}

/// Variance that the sensors' noise gives a balance, and how much of its acceleration it takes.
struct OfNoise {
    variance: f64,
    gain: f64,
}

fn of_noise(model: &ResidualModel, frame: &Frame) -> [OfNoise; BALANCES] {
    /// Samples of a piece: masses and scales are the same all along, and what a bent sensor reads is not by much.
    const SAMPLES: usize = 16;
    let noisy = frame.noisy.as_deref();
    let rows = noisy.map(|noisy| noisy.each_ref().map(|frame| model.residuals(frame)));
    let piece = noisy.map_or(frame, |[plus, _]| plus);
    let on_run = ModelOnRun::new(model, piece);
    let stride = piece.len().div_ceil(SAMPLES).max(1);
    let gains: Vec<[f64; BALANCES]> = piece
        .samples()
        .step_by(stride)
        .map(|i| on_run.gains(i))
        .collect();
    std::array::from_fn(|c| {
        let variance = rows.as_ref().map_or(0.0, |[plus, minus]| {
            let both = plus[c].iter().zip(&minus[c]);
            let squares: f64 = both.map(|(p, m)| (0.5 * (p - m)).powi(2)).sum();
            squares / plus[c].len().max(1) as f64
        });
        let gain = gains.iter().map(|g| g[c].abs()).sum::<f64>() / gains.len().max(1) as f64;
        OfNoise { variance, gain }
    })
}

/// How they change with each of these base parameters, `own` being what they are.
pub fn by_base(
    model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    (free_base, own): (&[usize], &[f64]),
) -> Vec<Vec<f64>> {
    let of = |b: &usize| {
        let mut moved = model.clone();
        moved.base[*b] += STEP;
        by_step(&moved, frames, used, own)
    };
    free_base.iter().map(of).collect()
}

/// How they change with each fitted amplitude of the model's effects, in the unit in which it is fitted.
pub fn by_amplitudes(
    model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    own: &[f64],
) -> Vec<Vec<f64>> {
    let of = |(e, q): (usize, usize)| {
        let mut moved = model.clone();
        moved.effects.active[e].values[q] += STEP * model.scale(e, q);
        by_step(&moved, frames, used, own)
    };
    model.free().into_iter().map(of).collect()
}

/// What a parameter is moved by, in the unit in which it is fitted.
const STEP: f64 = 0.01;

/// How they change with a parameter, from a model in which it is moved by a step.
fn by_step(
    moved: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    own: &[f64],
) -> Vec<f64> {
    let noise = log_noise(moved, frames, used);
    let both = noise.iter().zip(own);
    both.map(|(log, own)| (log - own) / STEP).collect()
}
