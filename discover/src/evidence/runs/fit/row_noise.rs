//! What the sensors' noise makes of a balance's residual by a model: one that counts less of what is noisy leaves less, and explains
//! nothing by it.
//!
//! The true motion is unknown, and noise of known deviations lies in the accelerations a as in what the forces are made of. With v the
//! covariance that it gives the residuals r of the balances by this model, and b what the model lacks of each acceleration itself, the
//! criterion of a fit is that of r over the covariance to expect, whose size is left open:
//!
//! ```text
//! n (ln det S - ln det(V + diag(b (dr/da)^2))) / 2,   S = r r' / n
//! ```
//!
//! Half masses, forces and inertias leave half the residual, and half of what is to be expected. V is found from a piece of each run with
//! noise of both signs upon it, the same for every model; b once, from what the base leaves.
//!
//! Source: R. J. Carroll, D. Ruppert, L. A. Stefanski, C. M. Crainiceanu, Measurement Error in Nonlinear Models (2006), section 3.4, where
//! b is the error in the equation; A. Zellner, An efficient method of estimating seemingly unrelated regressions, Journal of the American
//! Statistical Association 57 (1962) 348, for balances that share their noise.

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNELS, ChannelRows, ResidualModel,
};
use crate::evidence::runs::model::whiten::{Whitener, covariance};
use crate::evidence::runs::recordings::frame::Frame;

/// Mean over the runs of `ln det(V + diag(b (dr/da)^2)) / 2` of the balances in use.
pub fn log_noise(model: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS]) -> f64 {
    let of_run = |frame: &Frame| log_noise_of(model, frame, used) * frame.row_count() as f64;
    // One after the other, so that the sum does not depend on the threads.
    let each: Vec<f64> = frames.par_iter().map(of_run).collect();
    let rows: usize = frames.iter().map(Frame::row_count).sum();
    each.iter().sum::<f64>() / rows.max(1) as f64
}

/// The same of one run.
pub fn log_noise_of(model: &ResidualModel, frame: &Frame, used: [bool; CHANNELS]) -> f64 {
    Whitener::of(&expected(model, frame), used).log_scale()
}

/// `V + diag(b (dr/da)^2)` of one run.
pub fn expected(model: &ResidualModel, frame: &Frame) -> Matrix3<f64> {
    let of = of_noise(model, frame);
    let mut expected = of.covariance;
    for (c, beyond) in model.beyond_noise.iter().enumerate() {
        expected[(c, c)] += beyond * of.gain[c] * of.gain[c];
    }
    expected
}

/// What each balance leaves beyond the noise, over the square of what it takes of its acceleration.
pub fn beyond_noise(model: &ResidualModel, frames: &[Frame]) -> [f64; BALANCES] {
    let of_run = |frame: &Frame| -> [[f64; 2]; BALANCES] {
        let (noise, left) = (of_noise(model, frame), model.residuals(frame));
        std::array::from_fn(|c| {
            let gain = (noise.gain[c] * noise.gain[c]).max(1e-300);
            let squares: f64 = left[c].iter().map(|r| r * r).sum();
            let n = left[c].len() as f64;
            [n, (squares - n * noise.covariance[(c, c)]) / gain]
        })
    };
    let each: Vec<[[f64; 2]; BALANCES]> = frames.par_iter().map(of_run).collect();
    std::array::from_fn(|c| {
        let [n, beyond] = [0, 1].map(|k| each.iter().map(|run| run[c][k]).sum::<f64>());
        (beyond / n.max(1.0)).max(0.0)
    })
}

/// The same with this model where it is less than this share of what is known of any balance; else nothing.
///
/// What a large effect leaves is no error of the accelerations: counted as one, it would credit a model with all by which its residual
/// grows less than what it takes of them, and a bent sensor would explain more than the truth.
pub fn far_less_beyond(
    model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    share: f64,
) -> Option<[f64; BALANCES]> {
    let (known, found) = (model.beyond_noise, beyond_noise(model, frames));
    let falls = |c: usize| used[c] && found[c] < share * known[c];
    (0..BALANCES)
        .any(falls)
        .then(|| std::array::from_fn(|c| found[c].min(known[c])))
}

/// Covariance that the sensors' noise gives the balances, and how much of its acceleration each takes.
struct OfNoise {
    covariance: Matrix3<f64>,
    gain: [f64; BALANCES],
}

fn of_noise(model: &ResidualModel, frame: &Frame) -> OfNoise {
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
    let noise = rows.map(|[plus, minus]| -> ChannelRows {
        std::array::from_fn(|c| {
            let both = plus[c].iter().zip(&minus[c]);
            both.map(|(p, m)| 0.5 * (p - m)).collect()
        })
    });
    let gain = |c: usize| {
        let sum: f64 = gains.iter().map(|g: &[f64; BALANCES]| g[c].abs()).sum();
        sum / gains.len().max(1) as f64
    };
    OfNoise {
        covariance: covariance(noise.as_ref(), [true; CHANNELS]),
        gain: std::array::from_fn(gain),
    }
}

/// How it changes with each of these base parameters, `own` being what it is.
pub fn by_base(
    model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    (free_base, own): (&[usize], f64),
) -> Vec<f64> {
    let of = |b: &usize| {
        let mut moved = model.clone();
        moved.base[*b] += STEP;
        by_step(&moved, frames, used, own)
    };
    free_base.iter().map(of).collect()
}

/// How it changes with each fitted amplitude of the model's effects, in the unit in which it is fitted.
pub fn by_amplitudes(
    model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
    own: f64,
) -> Vec<f64> {
    let of = |(e, q): (usize, usize)| {
        let mut moved = model.clone();
        moved.effects.active[e].values[q] += STEP * model.scale(e, q);
        by_step(&moved, frames, used, own)
    };
    model.free().into_iter().map(of).collect()
}

/// What a parameter is moved by, in the unit in which it is fitted.
const STEP: f64 = 0.01;

/// How it changes with a parameter, from a model in which it is moved by a step.
fn by_step(moved: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS], own: f64) -> f64 {
    (log_noise(moved, frames, used) - own) / STEP
}
