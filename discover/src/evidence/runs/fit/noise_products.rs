//! Corrected scores: products of columns minus their bias due to noisy inputs.
//!
//! With columns x + e, where e is due to the noise of the inputs, products of columns and residuals
//! contain E[e e']. Slopes are attenuated, and an effect in one channel leaks into others. Pairs of
//! simulated runs of opposite noise measure E[e e'] at the fitted model. With it subtracted, the
//! normal equations are unbiased to second order in the noise.
//!
//! ```text
//! D_i = (X_i(+e)'X_i(+e) + X_i(-e)'X_i(-e))/2 - X_i(0)'X_i(0)        C_i = X_i'X_i - D_i
//! ```
//!
//! Source: T. Nakamura, Corrected score function for errors-in-variables models, Biometrika 77
//! (1990) 127.

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::evidence::runs::fit::piece::piece;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::gram::squares;

/// D_i of every run, local candidates last: from one pair of simulations of a piece of the run,
/// scaled to the whole run.
///
/// The Monte Carlo error of a pair is some tens of per cent of D_i within a run and a few per cent
/// over all runs.
pub fn noise_products(
    design: &Design,
    frames: &[Frame],
    simulator: &RunSimulator,
    round: u64,
) -> Vec<DMatrix<f64>> {
    frames
        .par_iter()
        .enumerate()
        .map(|(i, frame)| {
            let piece = piece(frame, simulator.piece_s, round, i);
            let pair = simulator.pair(&piece, design.residual_model, round, i);
            let square = |frame: &Frame| {
                let (columns, locals) = design.columns_and_locals(frame);
                let (m, n) = (columns.ncols(), locals.ncols());
                let mut x = columns.resize_horizontally(m + n, 0.0);
                x.columns_mut(m, n).copy_from(&locals);
                squares(&x)
            };
            let mean = (square(&pair.plus) + square(&pair.minus)) * 0.5;
            let share = frame.row_count() as f64 / piece.row_count().max(1) as f64;
            design.with_noiseless_discrepancy((mean - square(&pair.truth)) * share)
        })
        .collect()
}

/// The mean of [`noise_products`] over `pairs` pairs, at least one.
pub fn mean_noise_products(
    design: &Design,
    frames: &[Frame],
    simulator: &RunSimulator,
    pairs: u64,
) -> Vec<DMatrix<f64>> {
    let share = 1.0 / pairs as f64;
    let mut sums = noise_products(design, frames, simulator, 0);
    for round in 1..pairs {
        let one = noise_products(design, frames, simulator, round);
        sums.iter_mut().zip(one).for_each(|(sum, d)| *sum += d);
    }
    sums.iter_mut().for_each(|sum| *sum *= share);
    sums
}
