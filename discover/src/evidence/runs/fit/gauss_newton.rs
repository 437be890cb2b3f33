//! The base model and its effects, fitted together.

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

/// Residuals of all runs.
pub fn residuals(residual_model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    frames
        .par_iter()
        .map(|frame| residual_model.residuals(frame))
        .collect()
}

/// Which base parameters the data can move: a coefficient whose rows hardly change stays as it is given.
pub fn free_base(
    residual_model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
) -> Vec<usize> {
    let whitener = Whitener::estimate(&residuals(residual_model, frames), used);
    let design = Design {
        residual_model,
        whitener: &whitener,
        free_base: &[0, 1, 2, 3, 4],
        candidates: &[],
        local: &[],
        windows: &[],
    };
    let mut norms = [0.0; BASE];
    // Which parameters have leverage shows in any few runs.
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

/// How far a fit goes.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Steps at most.
    rounds: usize,
    /// A change of the criterion below which it ends.
    enough: f64,
    /// Whether noise is counted by the base that is fitted, rather than by that from which the fit starts: then the base is that of the
    /// criterion, which least squares would shrink.
    by_own_base: bool,
}

impl Effort {
    /// To a change far inside the noise.
    pub const FULL: Self = Self {
        rounds: 14,
        enough: 1e-3,
        by_own_base: false,
    };
    /// For comparisons, in which nothing below some units counts.
    pub const COMPARED: Self = Self {
        rounds: 14,
        enough: 0.1,
        by_own_base: true,
    };
    /// A preview, after which what leads is fitted on.
    pub const PREVIEW: Self = Self {
        rounds: 5,
        enough: 0.1,
        by_own_base: true,
    };
}

/// Base and effects as they fit.
#[derive(Clone)]
pub struct Fit {
    /// `n (ln(det S) / 2 - noise)`, n being the number of rows.
    pub criterion: f64,
    /// The model.
    pub model: ResidualModel,
    /// Its rows' whitening.
    pub whitener: Whitener,
}

/// Fits base and effects by Gauss-Newton, the installation as it is, the balances over the covariance S of their own residuals.
///
/// Minimises `n (ln(det S) / 2 - noise)` ([`LogNoise`]) over the effects, and over the base that or `n ln(det S) / 2`: least
/// squares with the covariance found along the way. Steps are halved until it falls; amplitudes stay in their bounds. It ends where a step gains or promises
/// next to nothing, and early where half as much again as it promises would leave more than `beat`.
///
/// # Errors
/// [`Error::BaseFit`] where a residual is not finite.
pub fn fit(
    residual_model: &ResidualModel,
    frames: &[Frame],
    free_base: &[usize],
    used: [bool; CHANNELS],
    effort: Effort,
    beat: f64,
) -> Result<Fit, Error> {
    let plain = Whitener::plain(used);
    let mut best: Option<(Fit, DVector<f64>)> = None;
    let mut trial = residual_model.clone();
    let mut share = 1.0;
    let mut by_base: Option<([f64; BASE], Vec<f64>)> = None;
    for _ in 0..effort.rounds {
        let design = Design {
            residual_model: &trial,
            whitener: &plain,
            free_base,
            candidates: &[],
            local: &[],
            windows: &[],
        };
        let p = design.fitted();
        let products = BalanceProducts::new(&design, frames);
        let finite = products.are_finite();
        if !finite && best.is_none() {
            return Err(Error::BaseFit {
                reason: "a residual is not a finite number".to_owned(),
            });
        }
        let whitener = Whitener::of(&products.covariance(), used);
        let mut based = trial.clone();
        if !effort.by_own_base {
            based.base = residual_model.base;
        }
        // How it changes with the base is found anew where that has moved far.
        let by_base_is_near = |(at, _): &([f64; BASE], Vec<f64>)| are_near(at, &trial.base);
        let moving: &[usize] =
            match effort.by_own_base && !by_base.as_ref().is_some_and(by_base_is_near) {
                true => free_base,
                false => &[],
            };
        let of_noise = LogNoise::new(&based, frames, used, moving);
        let noise = of_noise.own;
        let criterion = match finite {
            true => products.rows * (whitener.log_scale() - noise),
            false => f64::INFINITY,
        };
        let best_yet = best.as_ref().map_or(f64::INFINITY, |(b, _)| b.criterion);
        let gained = best_yet - criterion;
        if gained >= 0.0 {
            if !moving.is_empty() {
                by_base = Some((trial.base, of_noise.by_base));
            }
            let mut counted = DVector::zeros(p);
            let mut count = |first: usize, by: &[f64]| {
                by.iter()
                    .enumerate()
                    .for_each(|(k, by)| counted[first + k] = products.rows * by);
            };
            if let Some((_, by)) = &by_base {
                count(0, by);
            }
            count(free_base.len(), &of_noise.by_amplitudes);
            let step = joint_step(&products.weighted(&whitener), &counted);
            let after = Whitener::of(&products.covariance_after(&step), used);
            let promised = products.rows * (after.log_scale() - noise) - counted.dot(&step);
            let fit = Fit {
                criterion,
                model: trial.clone(),
                whitener,
            };
            best = Some((fit, step));
            share = 1.0;
            // What is promised holds to first order, and of a base that nobody has fitted not even that.
            let hopeless = gained.is_finite() && promised - 0.5 * (criterion - promised) > beat;
            // Where a step promises far less than what ends the search, it is not tried.
            let settled = (criterion - promised).abs() < 0.1 * effort.enough;
            if gained < effort.enough || settled || hopeless {
                break;
            }
        } else {
            share *= 0.5;
            if share < 0.01 {
                break;
            }
        }
        let (from, step) = best.as_ref().expect("the first round sets it");
        trial = stepped(&from.model, free_base, step.as_slice(), share);
    }
    let (mut fit, _) = best.expect("the first round sets it");
    if !effort.by_own_base {
        let rows: usize = frames.iter().map(Frame::row_count).sum();
        let noise = LogNoise::new(&fit.model, frames, used, &[]).own;
        fit.criterion = rows as f64 * (fit.whitener.log_scale() - noise);
    }
    Ok(fit)
}

/// The Gauss-Newton step of base and effects together, with what is added to their scores.
fn joint_step(total: &DMatrix<f64>, counted: &DVector<f64>) -> DVector<f64> {
    let p = counted.len();
    let jj = total.view((OWN_LEVELS, OWN_LEVELS), (p, p)).into_owned();
    let jr = total.view((OWN_LEVELS, OWN_LEVELS + p), (p, 1));
    ridge_inverse(jj) * (jr.column(0) + counted)
}

/// Whether no multiplier of one base is so far from that of another that noise changes otherwise there.
fn are_near(a: &[f64; BASE], b: &[f64; BASE]) -> bool {
    /// Chosen.
    const NEAR: f64 = 1.25;
    let near = |(a, b): (&f64, &f64)| (1.0 / NEAR..NEAR).contains(&(a / b));
    a.iter().zip(b).all(near)
}

/// Factor by which a step moves a multiplier of the base at most: from far away a step of one that these data hardly tell says nothing, and
/// leads to where they tell nothing of it at all. Chosen.
const FARTHEST: f64 = 2.0;

/// The model moved by a share of a step: base multipliers, then amplitudes in their units, then what the installation is off
/// by; all stay in their bounds.
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
        let active = &mut trial.effects.active[e];
        let (low, high) = match &active.kind {
            kufe_sled::effects::Kind::Catalogue(kind) => {
                let p = &kind.info().parameters[q];
                (p.low, p.high)
            }
            kufe_sled::effects::Kind::Custom(custom) => (custom.low, custom.high),
        };
        let value = active.values[q] + share * scale * step[free_base.len() + k];
        // An amplitude of exactly 0 would count as switched off.
        active.values[q] = if value == 0.0 {
            1e-12 * scale
        } else {
            value.clamp(low, high)
        };
    }
    let first = step.len() - trial.installation.fitted();
    let installed: Vec<f64> = step[first..].iter().map(|step| share * step).collect();
    trial.installation.step(&installed);
    trial
}
