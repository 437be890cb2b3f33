//! The base model and its effects, fitted together.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::chain::{BASE, CHANNELS, Chain, Rows};
use super::data::Frame;
use super::design::{Design, LEVELS};
use super::whiten::Whitener;
use crate::Error;
use crate::score::ridge_inverse;

/// Residuals of all runs.
pub fn residuals(chain: &Chain, frames: &[Frame]) -> Vec<Rows> {
    frames
        .par_iter()
        .map(|frame| chain.residuals(frame))
        .collect()
}

/// Which base parameters the data can move: a coefficient whose rows hardly change stays as it is given.
pub fn free_base(chain: &Chain, frames: &[Frame], used: [bool; CHANNELS]) -> Vec<usize> {
    let whitener = Whitener::estimate(&residuals(chain, frames), used);
    let design = Design {
        chain,
        whitener: &whitener,
        free_base: &[0, 1, 2, 3, 4],
        candidates: &[],
        local: &[],
        windows: &[],
    };
    let mut norms = [0.0; BASE];
    for frame in frames {
        let columns = design.columns(frame);
        for (b, norm) in norms.iter_mut().enumerate() {
            *norm += columns.column(LEVELS + b).norm_squared();
        }
    }
    let mut free = Vec::new();
    if used[0] && norms[0] > 0.0 {
        free.push(0);
    }
    for (saturating, stiffness) in [(1, 2), (3, 4)] {
        if norms[saturating] > 1e-4 * norms[stiffness] {
            free.push(saturating);
        }
        if norms[stiffness] > 0.0 {
            free.push(stiffness);
        }
    }
    free
}

/// Fits base and effects by Gauss-Newton on whitened rows.
///
/// The whitening is renewed in each of the first rounds. Steps are halved until the sum of squares falls; amplitudes stay in their bounds.
///
/// # Errors
/// [`Error::BaseFit`] where a residual is not finite.
pub fn fit(
    chain: &Chain,
    frames: &[Frame],
    free_base: &[usize],
    used: [bool; CHANNELS],
) -> Result<(Chain, Whitener), Error> {
    let mut chain = chain.clone();
    let mut whitener = Whitener::estimate(&residuals(&chain, frames), used);
    for round in 0..12 {
        let design = Design {
            chain: &chain,
            whitener: &whitener,
            free_base,
            candidates: &[],
            local: &[],
            windows: &[],
        };
        let p = design.fitted();
        let with_levels: Vec<DMatrix<f64>> =
            frames.par_iter().map(|f| full_gram(&design, f)).collect();
        let mut total = DMatrix::zeros(LEVELS + p + 1, LEVELS + p + 1);
        for gram in &with_levels {
            total += gram;
        }
        if !total.iter().all(|x| x.is_finite()) {
            return Err(Error::BaseFit {
                reason: "a residual is not a finite number".to_owned(),
            });
        }
        let step = joint_step(&total, p);
        let before = total[(LEVELS + p, LEVELS + p)];
        let scales: Vec<f64> = chain
            .free()
            .iter()
            .map(|(e, q)| design.scale(*e, *q))
            .collect();
        let mut share = 1.0;
        let mut moved = 0.0;
        for _ in 0..8 {
            let trial = stepped(&chain, free_base, &scales, &step, share);
            let after: f64 = residuals(&trial, frames)
                .iter()
                .map(|rows| whitener.apply(rows).iter().map(|x| x * x).sum::<f64>())
                .sum();
            if after <= before {
                moved = (before - after).abs() / before;
                chain = trial;
                break;
            }
            share *= 0.5;
        }
        if round < 4 {
            whitener = Whitener::estimate(&residuals(&chain, frames), used);
        } else if moved < 1e-7 {
            break;
        }
    }
    Ok((chain, whitener))
}

fn full_gram(design: &Design, frame: &Frame) -> DMatrix<f64> {
    let columns = design.columns(frame);
    columns.tr_mul(&columns)
}

/// The Gauss-Newton step of base and effects together.
fn joint_step(total: &DMatrix<f64>, p: usize) -> DVector<f64> {
    let jj = total.view((LEVELS, LEVELS), (p, p)).into_owned();
    let jr = total.view((LEVELS, LEVELS + p), (p, 1));
    (ridge_inverse(jj) * jr).column(0).into_owned()
}

/// Takes each run's levels out of its sums of products.
pub fn without_levels(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let m = gram.ncols();
    let rest = m - LEVELS;
    let own = ridge_inverse(gram.view((0, 0), (LEVELS, LEVELS)).into_owned());
    let cross = gram.view((0, LEVELS), (LEVELS, rest)).into_owned();
    gram.view((LEVELS, LEVELS), (rest, rest)) - cross.tr_mul(&(own * &cross))
}

fn stepped(
    chain: &Chain,
    free_base: &[usize],
    scales: &[f64],
    step: &DVector<f64>,
    share: f64,
) -> Chain {
    let mut trial = chain.clone();
    for (k, b) in free_base.iter().enumerate() {
        trial.base[*b] = (chain.base[*b] + share * step[k]).clamp(0.02, 50.0);
    }
    for (k, (e, q)) in chain.free().into_iter().enumerate() {
        let active = &mut trial.effects.active[e];
        let (low, high) = match &active.kind {
            kufe_sled::effects::Kind::Catalogue(kind) => {
                let p = &kind.info().parameters[q];
                (p.low, p.high)
            }
            kufe_sled::effects::Kind::Custom(custom) => (custom.low, custom.high),
        };
        let value = active.values[q] + share * scales[k] * step[free_base.len() + k];
        // An amplitude of exactly 0 would count as switched off.
        active.values[q] = if value == 0.0 {
            1e-12 * scales[k]
        } else {
            value.clamp(low, high)
        };
    }
    trial
}
