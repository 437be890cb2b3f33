//! Joint fit of the base model and its effects.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::Error;
use crate::evidence::runs::fit::balance_products::BalanceProducts;
use crate::evidence::runs::fit::row_noise::LogNoise;
use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::model::residual_model::{
    BASE, BOUNDS, CHANNELS, ChannelRows, ResidualModel,
};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::inverse::ridge_inverse;

pub fn residuals(residual_model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    frames
        .par_iter()
        .map(|frame| residual_model.residuals(frame))
        .collect()
}

/// Residuals of all runs given the estimated discrepancy.
pub fn conditional_residuals(model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    let mut runs = residuals(model, frames);
    for (frame, rows) in frames.iter().zip(&mut runs) {
        model.discrepancy.subtract(frame, rows);
    }
    runs
}

/// Base parameters with leverage; the others are fixed at their given values.
pub fn free_base(
    residual_model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
) -> Vec<usize> {
    let whitener = Whitener::estimate(frames, &residuals(residual_model, frames), used);
    let design = Design {
        residual_model,
        whitener: &whitener,
        free_base: &[0, 1, 2, 3, 4],
        candidates: &[],
        local: &[],
        windows: &[],
    };
    let mut norms = [0.0; BASE];
    // A few runs are enough to determine the leverage.
    for frame in frames.iter().take(6) {
        let columns = design.columns(frame);
        for (b, norm) in norms.iter_mut().enumerate() {
            *norm += columns.column(OWN_LEVELS + b).norm_squared();
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

/// A fit of base and effects.
#[derive(Clone)]
pub struct Fit {
    pub model: ResidualModel,
    pub whitener: Whitener,
}

/// Fits base and effects by Gauss-Newton with fixed installation errors, weighting the balances by
/// the covariance S of their residuals.
///
/// Minimises `n (ln(det S) / 2 - noise)`, where noise is [`LogNoise`] of the base from which the
/// fit starts: least squares with an estimated covariance. Steps are halved until the criterion
/// falls; amplitudes are bounded. Iterations end when a step gains next to nothing.
///
/// # Errors
/// [`Error::BaseFit`] if a residual is not finite.
pub fn fit(
    residual_model: &ResidualModel,
    frames: &[Frame],
    free_base: &[usize],
    used: [bool; CHANNELS],
) -> Result<Fit, Error> {
    const ROUNDS: usize = 14;
    /// Tolerance of the criterion, far below its noise.
    const ENOUGH: f64 = 1e-2;
    let plain = Whitener::plain(used);
    let mut best: Option<(f64, Fit, DVector<f64>)> = None;
    let mut trial = residual_model.clone();
    let mut share = 1.0;
    for _ in 0..ROUNDS {
        let design = Design {
            residual_model: &trial,
            whitener: &plain,
            free_base,
            candidates: &[],
            local: &[],
            windows: &[],
        };
        let products = BalanceProducts::new(&design, frames);
        let finite = products.are_finite();
        if !finite && best.is_none() {
            return Err(Error::BaseFit {
                reason: "a residual is not a finite number".to_owned(),
            });
        }
        let whitener = Whitener::of(&products.covariance(), used);
        let based = ResidualModel {
            base: residual_model.base,
            ..trial.clone()
        };
        let noise = match trial.free().is_empty() {
            // Without an amplitude it is the same for every trial.
            true => LogNoise::default(),
            false => LogNoise::new(&based, frames, used),
        };
        let criterion = match finite {
            true => products.rows * (whitener.log_scale() - noise.own),
            false => f64::INFINITY,
        };
        let gained = best
            .as_ref()
            .map_or(f64::INFINITY, |(least, ..)| least - criterion);
        if gained >= 0.0 {
            let mut counted = DVector::zeros(design.fitted());
            for (k, by) in noise.by_amplitudes.iter().enumerate() {
                counted[free_base.len() + k] = products.rows * by;
            }
            let step = joint_step(&products.weighted(&whitener), &counted);
            let after = Whitener::of(&products.covariance_after(&step), used);
            let predicted = products.rows * (after.log_scale() - noise.own) - counted.dot(&step);
            let model = trial.clone();
            best = Some((criterion, Fit { model, whitener }, step));
            share = 1.0;
            if gained < ENOUGH || (criterion - predicted).abs() < ENOUGH {
                break;
            }
        } else {
            share *= 0.5;
            if share < 0.01 {
                break;
            }
        }
        let (_, from, step) = best.as_ref().expect("the first round sets it");
        trial = stepped(&from.model, free_base, step.as_slice(), share);
    }
    let (_, fit, _) = best.expect("the first round sets it");
    Ok(fit)
}

/// The Gauss-Newton step of base and effects together; `counted` is added to their scores.
fn joint_step(total: &DMatrix<f64>, counted: &DVector<f64>) -> DVector<f64> {
    let p = counted.len();
    let jj = total.view((OWN_LEVELS, OWN_LEVELS), (p, p)).into_owned();
    let jr = total.view((OWN_LEVELS, OWN_LEVELS + p), (p, 1));
    ridge_inverse(jj) * (jr.column(0) + counted)
}

/// Largest factor by which a step moves a base multiplier: a long step along a poorly determined
/// direction leads to where the data do not determine it at all. Chosen.
const FARTHEST: f64 = 2.0;

/// The model moved by a share of a step: base multipliers, amplitudes in their units, then
/// installation errors; all remain within bounds.
pub fn stepped(
    residual_model: &ResidualModel,
    free_base: &[usize],
    step: &[f64],
    share: f64,
) -> ResidualModel {
    let mut trial = residual_model.clone();
    for (k, b) in free_base.iter().enumerate() {
        let from = residual_model.base[*b];
        let next = (from + share * step[k]).clamp(from / FARTHEST, from * FARTHEST);
        trial.base[*b] = next.clamp(BOUNDS[0], BOUNDS[1]);
    }
    for (k, (e, q)) in residual_model.free().into_iter().enumerate() {
        let scale = residual_model.scale(e, q);
        let [low, high] = residual_model.bounds(e, q);
        let active = &mut trial.effects.active[e];
        let value = active.values[q] + share * scale * step[free_base.len() + k];
        // An amplitude of exactly 0 would count as switched off.
        active.values[q] = if value == 0.0 {
            1e-12 * scale
        } else {
            value.clamp(low, high)
        };
    }
    let smooth = step.len() - trial.discrepancy.fitted();
    let first = smooth - trial.installation.fitted();
    let installed: Vec<f64> = step[first..smooth]
        .iter()
        .map(|step| share * step)
        .collect();
    trial.installation.step(&installed);
    for (size, step) in trial.discrepancy.sizes.iter_mut().zip(&step[smooth..]) {
        *size += share * step;
    }
    trial
}
