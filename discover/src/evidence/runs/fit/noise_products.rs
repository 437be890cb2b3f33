//! Corrected scores: products of columns, less the bias by noisy inputs.
//!
//! With columns x + e, e the noise of the inputs, products of columns and residuals contain E[e
//! e']. Slopes are attenuated, and an effect in one channel leaks into others. Pairs of simulated
//! runs of opposite noise measure E[e e'] at the fitted model. With it subtracted, the normal
//! equations are unbiased to second order in the noise.
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
use crate::evidence::runs::model::design::{Design, OWN_LEVELS, Products};
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::gram::squares;
use crate::regression::prior::Prior;

/// D_i of every run, local candidates last, from one pair of simulated runs of a third of it,
/// scaled to the whole.
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
            design.without_noise((mean - square(&pair.truth)) * share)
        })
        .collect()
}

/// Products of the fitted columns and the residual by run, and their bias by noise.
pub fn fitted_products(
    design: &Design,
    products: &[Products],
    noise: &[DMatrix<f64>],
) -> Vec<[DMatrix<f64>; 2]> {
    let n = design.fitted() + 1;
    let fitted = |all: &DMatrix<f64>| all.view((OWN_LEVELS, OWN_LEVELS), (n, n)).into_owned();
    let runs = products.iter().zip(noise);
    runs.map(|(x, d)| [&x.full, d].map(fitted)).collect()
}

/// Largest share of a combination of columns that is taken to be noise. Chosen: the correction at
/// most doubles an estimate, since that of a larger share depends on how well the noise is known.
const MOST_NOISE: f64 = 0.5;

/// Products less their bias, `C_i = A_i - D_i`, from A_i and D_i of every run; the residual is last.
///
/// The sum of all C_i and of the prior precision P of the columns need not be positive definite.
/// With `A + P = L L'` and `inv(L) D inv(L)' = U G U'` of the columns, values g above one half are
/// reduced to it: D_i becomes `K D_i K'` with `K = L U sqrt(min(G, 1/2) / G) U' inv(L)`.
pub fn corrected(runs: &[[DMatrix<f64>; 2]], prior: &Prior) -> Vec<DMatrix<f64>> {
    let p = prior.count();
    let sum = |k: usize| -> DMatrix<f64> {
        let zero = DMatrix::zeros(p, p);
        let own = runs.iter().map(|run| run[k].view((0, 0), (p, p)));
        own.fold(zero, |sum, own| sum + own)
    };
    let (mut whole, noise) = (sum(0), sum(1));
    for (k, precision) in prior.precision.iter().enumerate() {
        // Columns of another track are zero and have no noise.
        whole[(k, k)] += precision.max(1e-9 * whole[(k, k)]).max(1e-300);
    }
    let mut reduction = DMatrix::identity(p + 1, p + 1);
    if (&whole * MOST_NOISE - &noise).cholesky().is_none()
        && let Some(root) = whole.cholesky().map(|root| root.l())
        && let Some(inverse) = root.clone().try_inverse()
    {
        let eigen = (&inverse * noise * inverse.transpose()).symmetric_eigen();
        let shares = eigen
            .eigenvalues
            .map(|g| (MOST_NOISE / g.max(MOST_NOISE)).sqrt());
        let vectors = &eigen.eigenvectors;
        let own = vectors * DMatrix::from_diagonal(&shares) * vectors.transpose();
        reduction
            .view_mut((0, 0), (p, p))
            .copy_from(&(root * own * inverse));
    }
    let less = |[a, d]: &[DMatrix<f64>; 2]| a - &reduction * d * reduction.transpose();
    runs.iter().map(less).collect()
}

/// The mean of [`noise_products`] over several pairs.
pub fn mean_noise_products(
    design: &Design,
    frames: &[Frame],
    simulator: &RunSimulator,
    rounds: std::ops::Range<u64>,
) -> Vec<DMatrix<f64>> {
    let share = 1.0 / (rounds.end - rounds.start) as f64;
    let mut sums: Vec<DMatrix<f64>> = Vec::new();
    for round in rounds {
        let one = noise_products(design, frames, simulator, round);
        if sums.is_empty() {
            sums = one;
        } else {
            sums.iter_mut().zip(one).for_each(|(sum, d)| *sum += d);
        }
    }
    sums.iter_mut().for_each(|sum| *sum *= share);
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::{normal, stream};

    /// Three columns and a residual of two runs.
    fn products(noise: f64) -> Vec<[DMatrix<f64>; 2]> {
        let mut rng = stream(2, 7, 1);
        let mut of = || {
            let x = DMatrix::from_fn(50, 4, |_, _| normal(&mut rng));
            let mut bias = DMatrix::identity(4, 4) * 5.0;
            bias[(0, 0)] = noise;
            bias[(0, 3)] = 0.1 * noise;
            bias[(3, 0)] = 0.1 * noise;
            [squares(&x), bias]
        };
        vec![of(), of()]
    }

    #[test]
    fn small_bias_is_subtracted_and_large_bias_at_most_halves_a_column() {
        let mut prior = Prior::none(3);
        prior.precision[1] = 4.0;
        for (both, c) in products(5.0).iter().zip(corrected(&products(5.0), &prior)) {
            assert_eq!(c, &both[0] - &both[1]);
        }
        // More noise than signal: the plain difference has a negative eigenvalue.
        let runs = products(80.0);
        let total = |runs: &[DMatrix<f64>]| {
            let mut sum = runs[0].clone() + &runs[1];
            sum[(1, 1)] += 4.0;
            sum.view((0, 0), (3, 3)).into_owned()
        };
        let plain: Vec<DMatrix<f64>> = runs.iter().map(|run| run[0].clone()).collect();
        let [whole, reduced] = [total(&plain), total(&corrected(&runs, &prior))];
        let least = (reduced - whole * (1.0 - MOST_NOISE))
            .symmetric_eigenvalues()
            .min();
        // Up to the small precision of columns without a prior.
        assert!(least > -1e-6, "{least}");
    }
}
