//! Fitted parameters with intervals: bias of noisy inputs taken off, errors from the scatter of whole runs.

use nalgebra::DMatrix;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::chain::Chain;
use super::data::Frame;
use super::design::{Design, LEVELS};
use super::fit::residuals;
use super::twins::TwinMaker;
use super::whiten::Whitener;
use crate::score::ridge_inverse;

/// A parameter in its own unit (base parameters: as multipliers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value, the twins' bias taken off.
    pub value: f64,
    /// Standard error.
    pub error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Estimates of all fitted parameters at the fitted chain.
///
/// One Gauss-Newton step from the fit on each twin shows how noisy inputs move the estimates; their mean is taken off.
/// The error is the sandwich over runs, inv(J'J) sum_i (J_i'r_i)(J_i'r_i)' inv(J'J), with Student's t of R - 1.
pub fn estimate(
    chain: &Chain,
    whitener: &Whitener,
    frames: &[Frame],
    free: &[usize],
    maker: &TwinMaker,
    twins: u64,
) -> Vec<Estimate> {
    let design = Design {
        chain,
        whitener,
        free_base: free,
        candidates: &[],
        local: &[],
        windows: &[],
    };
    let p = design.fitted();
    let full = |frames: &[Frame]| -> Vec<DMatrix<f64>> {
        frames
            .iter()
            .map(|f| {
                let x = design.columns(f);
                x.tr_mul(&x)
            })
            .collect()
    };
    let real = full(frames);
    let rows = residuals(chain, frames);
    let steps: Vec<Vec<f64>> = (0..twins)
        .into_par_iter()
        .map(|k| step(&full(&maker.make(frames, chain, &rows, 4_000_037 + k)), p).0)
        .collect();
    let (_, errors) = step(&real, p);
    let scales: Vec<f64> = vec![1.0; free.len()]
        .into_iter()
        .chain(chain.free().iter().map(|(e, q)| design.scale(*e, *q)))
        .collect();
    let current: Vec<f64> = free
        .iter()
        .map(|b| chain.base[*b])
        .chain(
            chain
                .free()
                .iter()
                .map(|(e, q)| chain.effects.active[*e].values[*q]),
        )
        .collect();
    let n = frames.len() as f64;
    let quantile =
        StudentsT::new(0.0, 1.0, (n - 1.0).max(1.0)).map_or(2.0, |law| law.inverse_cdf(0.975));
    (0..p)
        .map(|k| {
            let mean = steps.iter().map(|s| s[k]).sum::<f64>() / steps.len() as f64;
            let scatter = steps.iter().map(|s| (s[k] - mean).powi(2)).sum::<f64>()
                / (steps.len() as f64 - 1.0);
            // The twins' own scatter is a second account of the error; the larger one counts.
            let error =
                (errors[k].powi(2).max(scatter) + scatter / steps.len() as f64).sqrt() * scales[k];
            let value = current[k] - mean * scales[k];
            Estimate {
                value,
                error,
                low: value - quantile * error,
                high: value + quantile * error,
            }
        })
        .collect()
}

/// One step and its sandwich errors.
fn step(grams: &[DMatrix<f64>], p: usize) -> (Vec<f64>, Vec<f64>) {
    let own: Vec<DMatrix<f64>> = grams
        .iter()
        .map(|g| g.view((LEVELS, LEVELS), (p + 1, p + 1)).into_owned())
        .collect();
    solve(&own, p)
}

fn solve(grams: &[DMatrix<f64>], p: usize) -> (Vec<f64>, Vec<f64>) {
    let mut total = DMatrix::zeros(p + 1, p + 1);
    for gram in grams {
        total += gram;
    }
    let inverse = ridge_inverse(total.view((0, 0), (p, p)).into_owned());
    let step = &inverse * total.view((0, p), (p, 1));
    let mut meat = DMatrix::zeros(p, p);
    for gram in grams {
        let score = gram.view((0, p), (p, 1)) - gram.view((0, 0), (p, p)) * &step;
        meat += &score * score.transpose();
    }
    let n = grams.len() as f64;
    let covariance = &inverse * meat * &inverse * (n / (n - 1.0).max(1.0));
    (
        step.column(0).iter().copied().collect(),
        (0..p).map(|k| covariance[(k, k)].max(0.0).sqrt()).collect(),
    )
}
