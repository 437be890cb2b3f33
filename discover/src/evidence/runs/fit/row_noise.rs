//! Covariance of the residuals due to sensor noise.
//!
//! A model that gives less weight to noisy terms has smaller residuals without explaining anything.
//! The criterion of a fit is therefore relative to the covariance expected of noise. With V the
//! covariance of the residuals r of the balances due to noise of the accelerations a and of the
//! inputs of the forces, and b the model error as a variance of each acceleration, it is, up to
//! scale,
//!
//! ```text
//! n (ln det S - ln det(V + diag(b (dr/da)^2))) / 2,   S = r r' / n
//! ```
//!
//! Halving masses, forces and inertias halves both the residual and its expected size. V is found
//! from a piece of each run with noise of both signs, the same for every model; b once, from the
//! residuals of the base.
//!
//! Source: R. J. Carroll, D. Ruppert, L. A. Stefanski, C. M. Crainiceanu, Measurement Error in
//! Nonlinear Models (2006), section 3.4, where b is the error in the equation; A. Zellner, An
//! efficient method of estimating seemingly unrelated regressions, Journal of the American
//! Statistical Association 57 (1962) 348, for balances that share their noise.

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNELS, ChannelRows, ResidualModel, TRACK,
};
use crate::evidence::runs::model::whiten::{Whitener, covariance, scaled};
use crate::evidence::runs::recordings::frame::Frame;

/// Mean of `ln det(V + diag(b (dr/da)^2)) / 2` over the runs, and its derivatives.
#[derive(Default)]
pub struct LogNoise {
    /// Value for this model.
    pub own: f64,
    /// Derivative by each fitted amplitude, in the unit in which it is fitted.
    pub by_amplitudes: Vec<f64>,
}

impl LogNoise {
    pub fn new(model: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS]) -> Self {
        let free = model.free();
        let moved: Vec<ResidualModel> = free
            .iter()
            .map(|(e, q)| {
                let mut moved = model.clone();
                moved.effects.active[*e].values[*q] += STEP * model.scale(*e, *q);
                moved
            })
            .collect();
        let of_run = |frame: &Frame| -> Vec<f64> {
            let n = frame.row_count() as f64;
            let each = of_noise(model, &moved, frame).into_iter();
            each.map(|of| n * Whitener::of(&of.expected(model), used).log_scale())
                .collect()
        };
        let each: Vec<Vec<f64>> = frames.par_iter().map(of_run).collect();
        let rows: usize = frames.iter().map(Frame::row_count).sum();
        // Sequential, so that the sum does not depend on the threads.
        let mean = |k: usize| each.iter().map(|run| run[k]).sum::<f64>() / rows.max(1) as f64;
        let own = mean(0);
        let slope = |k: usize| (mean(k) - own) / STEP;
        Self {
            own,
            by_amplitudes: (1..=free.len()).map(slope).collect(),
        }
    }
}

/// Step of the differences, in the unit in which a parameter is fitted.
const STEP: f64 = 0.01;

/// `ln det(V + diag(b (dr/da)^2)) / 2` of one run.
pub fn log_noise_of(model: &ResidualModel, frame: &Frame, used: [bool; CHANNELS]) -> f64 {
    Whitener::of(&expected(model, frame), used).log_scale()
}

/// `V + diag(b (dr/da)^2)` of one run.
pub fn expected(model: &ResidualModel, frame: &Frame) -> Matrix3<f64> {
    own_noise(model, frame).expected(model)
}

/// Model error of each balance as a variance of its acceleration: (mean square - noise)/(dr/da)^2.
pub fn model_error(model: &ResidualModel, frames: &[Frame]) -> [f64; BALANCES] {
    let of_run = |frame: &Frame| -> [[f64; 2]; BALANCES] {
        let (noise, mut residual) = (own_noise(model, frame), model.residuals(frame));
        model.discrepancy.subtract(frame, &mut residual);
        let ones = residual.clone().map(|rows| vec![1.0; rows.len()]);
        let [residual, weights] = [residual, ones].map(|rows| scaled(frame, &rows));
        let squares = |rows: &[f64]| rows.iter().map(|r| r * r).sum::<f64>();
        std::array::from_fn(|c| {
            let gain = (noise.gain[c] * noise.gain[c]).max(1e-300);
            let n = squares(&weights[c]);
            [
                n,
                (squares(&residual[c]) - n * noise.covariance[(c, c)]) / gain,
            ]
        })
    };
    let each: Vec<[[f64; 2]; BALANCES]> = frames.par_iter().map(of_run).collect();
    std::array::from_fn(|c| {
        let [n, excess] = [0, 1].map(|k| each.iter().map(|run| run[c][k]).sum::<f64>());
        (excess / n.max(1.0)).max(0.0)
    })
}

/// Covariance of the balances due to sensor noise, and dr/da of each.
struct NoiseCovariance {
    covariance: Matrix3<f64>,
    gain: [f64; BALANCES],
}

impl NoiseCovariance {
    fn expected(&self, model: &ResidualModel) -> Matrix3<f64> {
        let mut expected = self.covariance;
        for (c, excess) in model.model_error.iter().enumerate() {
            expected[(c, c)] += excess * self.gain[c] * self.gain[c];
        }
        expected
    }
}

fn own_noise(model: &ResidualModel, frame: &Frame) -> NoiseCovariance {
    let [own] = of_noise(model, &[], frame)
        .try_into()
        .unwrap_or_else(|_| unreachable!("one model"));
    own
}

/// For a model and variants that differ by an amplitude: all share one evaluation of the base laws.
fn of_noise(model: &ResidualModel, moved: &[ResidualModel], frame: &Frame) -> Vec<NoiseCovariance> {
    /// Samples of a piece: masses and scales are (almost) constant.
    const SAMPLES: usize = 16;
    let count = 1 + moved.len();
    let noisy = frame.noisy.as_deref();
    let pieces: Vec<&Frame> = noisy.map_or_else(|| vec![frame], |noisy| noisy.iter().collect());
    let mut on_pieces: Vec<Vec<ModelOnRun>> = Vec::new();
    for piece in &pieces {
        let models = std::iter::once(model).chain(moved);
        on_pieces.push(models.map(|model| ModelOnRun::new(model, piece)).collect());
    }
    let (on_run, piece) = (&on_pieces[0], pieces[0]);
    let mut gains = vec![[0.0; BALANCES]; count];
    let samples = piece
        .samples()
        .step_by(piece.len().div_ceil(SAMPLES).max(1));
    let mut sampled = 0.0;
    for i in samples {
        let at = on_run[0].with_more_acceleration(i);
        let each = on_run.iter().map(|model| model.gains(i, &at));
        for (sum, gain) in gains.iter_mut().zip(each) {
            (0..BALANCES).for_each(|c| sum[c] += gain[c].abs());
        }
        sampled += 1.0;
    }
    let rows = |(piece, models): (&&Frame, &Vec<ModelOnRun>)| -> Vec<[Vec<f64>; BALANCES]> {
        let mut raw = vec![[(); BALANCES].map(|()| Vec::with_capacity(piece.len())); count];
        for i in 0..piece.len() {
            let at = models[0].instant(i, &models[0].measured(i));
            let each = models.iter().map(|model| model.balances_given(i, &at));
            for (raw, values) in raw.iter_mut().zip(each) {
                raw.iter_mut().zip(values).for_each(|(raw, x)| raw.push(x));
            }
        }
        let low_passed = raw.into_iter().map(|raw| raw.map(|x| piece.rows(&x)));
        low_passed.collect()
    };
    let rows: Vec<Vec<[Vec<f64>; BALANCES]>> = match noisy {
        Some(_) => pieces.iter().zip(&on_pieces).map(rows).collect(),
        None => Vec::new(),
    };
    let of = |(k, gain): (usize, [f64; BALANCES])| {
        let noise = noisy.map(|_| -> ChannelRows {
            std::array::from_fn(|c| match c {
                TRACK => Vec::new(),
                _ => {
                    let both = rows[0][k][c].iter().zip(&rows[1][k][c]);
                    both.map(|(p, m)| 0.5 * (p - m)).collect()
                }
            })
        });
        NoiseCovariance {
            covariance: covariance(noise.as_ref(), [true; CHANNELS]),
            gain: gain.map(|sum| sum / f64::max(sampled, 1.0)),
        }
    };
    gains.into_iter().enumerate().map(of).collect()
}
