//! Regression of the levels of friction and grip of sessions and runs on weather and order.

use std::collections::BTreeMap;

use kufe_sled::correlation;
use kufe_sled::effects::Level;

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::noise_products::noise_products;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::recordings::frame::Frame;
use crate::null::clusters::members;
use crate::null::permutations::by_session_permutation;
use crate::null::random::{shuffle, stream};
use crate::procedure::candidate::Candidate;
use crate::regression::inverse::ridge_inverse;

/// Scores of a candidate between sessions or runs.
#[derive(Clone, Debug)]
pub struct LevelScore {
    /// Correlation of the levels with the candidate.
    pub correlation: f64,
    /// p-value by permutation, over all candidates of its kind.
    pub p_value: f64,
    pub size: f64,
    pub error: f64,
    /// Explained sum of squares of the whitened rows.
    pub gain: f64,
}

/// Levels by run, their sessions and the candidates' covariates.
pub struct LevelScreen {
    /// Scores in the order of the candidates.
    pub seen: Vec<LevelScore>,
    pub sessions: usize,
    /// p-values of an F test of differences between sessions, for friction and for grip.
    pub sessions_differ: [f64; OWN_LEVELS],
    /// Mean covariate of each session, by candidate.
    covariates: Vec<Vec<f64>>,
    /// Level that each candidate changes most: 0 friction, 1 grip.
    level_of: Vec<usize>,
    /// Mean of each level by session.
    means: [Vec<f64>; OWN_LEVELS],
}

/// Scores the candidates of `design`, all of which must act between sessions or between runs.
pub fn screen_levels(
    design: &Design,
    frames: &[Frame],
    candidates: &[Candidate<Amplitude>],
    simulator: &RunSimulator,
    seed: u64,
) -> LevelScreen {
    let q = candidates.len();
    let first = OWN_LEVELS + design.fitted_count();
    let mut levels: Vec<[f64; OWN_LEVELS]> = Vec::new();
    let mut weights: Vec<[f64; OWN_LEVELS]> = Vec::new();
    let mut covariates = vec![Vec::new(); q];
    let mut level_of = vec![0; q];
    let mut explained = vec![[0.0; OWN_LEVELS]; q];
    let mut by_run: Vec<Vec<[f64; OWN_LEVELS]>> = vec![Vec::new(); q];
    let products = design.products(frames);
    let noise = noise_products(design, frames, simulator, 6_000_029);
    for (products, noise) in products.iter().zip(&noise) {
        let matrix = &products.full - noise;
        let m = matrix.ncols();
        let square = matrix.view((0, 0), (OWN_LEVELS, OWN_LEVELS)).into_owned();
        let inverse = ridge_inverse(square.clone());
        let level = &inverse * matrix.view((0, m - 1), (OWN_LEVELS, 1)).column(0);
        levels.push([level[0], level[1]]);
        weights.push([square[(0, 0)], square[(1, 1)]]);
        for (c, by_run) in by_run.iter_mut().enumerate() {
            let z = &inverse * matrix.view((0, first + c), (OWN_LEVELS, 1)).column(0);
            for k in 0..OWN_LEVELS {
                explained[c][k] += z[k] * z[k] * square[(k, k)];
            }
            by_run.push([z[0], z[1]]);
        }
    }
    for c in 0..q {
        level_of[c] = usize::from(explained[c][1] > explained[c][0]);
        covariates[c] = by_run[c].iter().map(|z| z[level_of[c]]).collect();
    }
    let sessions = group(frames);
    let mean_of = |x: &[f64]| -> Vec<f64> {
        sessions
            .values()
            .map(|runs| runs.iter().map(|i| x[*i]).sum::<f64>() / runs.len() as f64)
            .collect()
    };
    let of_level = |k: usize| -> Vec<f64> { levels.iter().map(|l| l[k]).collect() };
    let means: [Vec<f64>; OWN_LEVELS] = [mean_of(&of_level(0)), mean_of(&of_level(1))];
    let session_covariates: Vec<Vec<f64>> = covariates.iter().map(|z| mean_of(z)).collect();
    let mut seen = vec![None; q];
    for k in 0..OWN_LEVELS {
        let of_session =
            |c: &usize| level_of[*c] == k && candidates[*c].act.level == Level::Session;
        let tested: Vec<usize> = (0..q).filter(of_session).collect();
        if tested.is_empty() || means[k].len() < 3 {
            continue;
        }
        let xs: Vec<Vec<f64>> = tested
            .iter()
            .map(|c| session_covariates[*c].clone())
            .collect();
        let permuted = by_session_permutation(&means[k], &xs, 3999, seed);
        for ((c, x), (_, p)) in tested.iter().zip(&xs).zip(&permuted) {
            let weight: f64 = weights.iter().map(|w| w[k]).sum::<f64>() / means[k].len() as f64;
            let mut one = slope(&means[k], x, candidates[*c].typical, weight);
            one.p_value = *p;
            seen[*c] = Some(one);
        }
    }
    for k in 0..OWN_LEVELS {
        let of_runs = |c: &usize| level_of[*c] == k && candidates[*c].act.level == Level::Run;
        let tested: Vec<usize> = (0..q).filter(of_runs).collect();
        let Some(first) = tested.first() else {
            continue;
        };
        let y = within(&of_level(k), &sessions);
        let xs: Vec<Vec<f64>> = (tested.iter())
            .map(|c| within(&covariates[*c], &sessions))
            .collect();
        let observed: Vec<f64> = xs.iter().map(|x| correlation(&y, x).abs()).collect();
        let permutations = 1999;
        let mut above = vec![1; tested.len()];
        for trial in 0..permutations {
            let mut rng = stream(seed, 0x0BDE + *first as u64, trial);
            let mut permuted = y.clone();
            for runs in sessions.values() {
                let mut order = runs.clone();
                shuffle(&mut rng, &mut order);
                for (to, from) in runs.iter().zip(&order) {
                    permuted[*to] = y[*from];
                }
            }
            // The largest of all candidates: the p-value is corrected for their number (max-T).
            let largest = xs.iter().map(|x| correlation(&permuted, x).abs());
            let largest = largest.fold(0.0, f64::max);
            for (above, observed) in above.iter_mut().zip(&observed) {
                *above += i32::from(largest >= observed - 1e-12);
            }
        }
        let weight: f64 = weights.iter().map(|w| w[k]).sum::<f64>() / y.len() as f64;
        for ((c, x), above) in tested.iter().zip(&xs).zip(above) {
            let mut one = slope(&y, x, candidates[*c].typical, weight);
            one.p_value = f64::from(above) / (permutations + 1) as f64;
            seen[*c] = Some(one);
        }
    }
    let nothing = LevelScore {
        correlation: 0.0,
        p_value: 1.0,
        size: 0.0,
        error: f64::INFINITY,
        gain: 0.0,
    };
    let sessions_differ = [0, 1].map(|k| f_test(&of_level(k), &sessions));
    LevelScreen {
        seen: seen
            .into_iter()
            .map(|s| s.unwrap_or_else(|| nothing.clone()))
            .collect(),
        sessions: sessions.len(),
        sessions_differ,
        covariates: session_covariates,
        level_of,
        means,
    }
}

/// Smallest p-value by permutation of `sessions` sessions, where only the order and its reverse
/// tie.
pub fn min_p_value(sessions: usize) -> f64 {
    2.0 / (1..=sessions.min(10)).product::<usize>() as f64
}

impl LevelScreen {
    /// t of session-level candidate `a` given `b`; unchanged if they act on different levels.
    pub fn t_given(&self, a: usize, b: usize) -> f64 {
        if self.level_of[a] != self.level_of[b] {
            return self.seen[a].size / self.seen[a].error.max(1e-300);
        }
        let y = centred(&self.means[self.level_of[a]]);
        let (x, z) = (centred(&self.covariates[a]), centred(&self.covariates[b]));
        let zz: f64 = dot(&z, &z).max(1e-300);
        let free = |v: &[f64]| -> Vec<f64> {
            let share = dot(v, &z) / zz;
            v.iter().zip(&z).map(|(v, z)| v - share * z).collect()
        };
        let (y, x) = (free(&y), free(&x));
        let xx = dot(&x, &x);
        if xx < 1e-9 * dot(&centred(&self.covariates[a]), &centred(&self.covariates[a])) {
            return 0.0;
        }
        let slope = dot(&x, &y) / xx;
        let rest: f64 = y.iter().zip(&x).map(|(y, x)| (y - slope * x).powi(2)).sum();
        let freedom = (y.len() as f64 - 3.0).max(1.0);
        slope / (rest / freedom / xx).sqrt().max(1e-300)
    }
}

/// Indices of the runs of each session.
pub fn group(frames: &[Frame]) -> BTreeMap<&str, Vec<usize>> {
    members(frames.iter().map(|frame| frame.session.as_str()))
}

/// Values minus the mean of their session.
fn within(x: &[f64], sessions: &BTreeMap<&str, Vec<usize>>) -> Vec<f64> {
    let mut out = x.to_vec();
    for runs in sessions.values() {
        let mean = runs.iter().map(|i| x[*i]).sum::<f64>() / runs.len() as f64;
        for i in runs {
            out[*i] -= mean;
        }
    }
    out
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| v - mean).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Simple linear regression of y on x, per unit of `typical`; without a p-value.
fn slope(y: &[f64], x: &[f64], typical: f64, weight: f64) -> LevelScore {
    let (yc, xc) = (centred(y), centred(x));
    let xx = dot(&xc, &xc).max(1e-300);
    let size = dot(&yc, &xc) / xx;
    let rest: f64 = yc
        .iter()
        .zip(&xc)
        .map(|(y, x)| (y - size * x).powi(2))
        .sum();
    let error = (rest / (y.len() as f64 - 2.0).max(1.0) / xx).sqrt();
    LevelScore {
        correlation: correlation(y, x),
        p_value: 1.0,
        size: size * typical,
        error: error * typical,
        gain: size * size * xx * weight,
    }
}

/// One-way analysis of variance: p-value of the differences between sessions.
pub fn f_test(x: &[f64], sessions: &BTreeMap<&str, Vec<usize>>) -> f64 {
    use statrs::distribution::{ContinuousCDF, FisherSnedecor};
    let (n, g) = (x.len() as f64, sessions.len() as f64);
    let inner: f64 = within(x, sessions).iter().map(|v| v * v).sum();
    let total: f64 = centred(x).iter().map(|v| v * v).sum();
    if g < 2.0 || n - g < 1.0 || inner <= 0.0 {
        return 1.0;
    }
    let f = ((total - inner) / (g - 1.0)) / (inner / (n - g));
    FisherSnedecor::new(g - 1.0, n - g).map_or(1.0, |law| 1.0 - law.cdf(f))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analysis_of_variance_equals_that_of_scipy() {
        let x = [1.0, 2.0, 3.5, 2.0, 3.0, 4.0, 5.0, 6.0, 9.0, 7.5];
        let sessions = BTreeMap::from([
            ("a", vec![0, 1, 2]),
            ("b", vec![3, 4, 5]),
            ("c", vec![6, 7, 8, 9]),
        ]);
        // scipy.stats.f_oneway, version 1.17.1
        let p = f_test(&x, &sessions);
        assert!((p / 0.006855845733558317 - 1.0).abs() < 1e-9, "{p}");
        assert_eq!(f_test(&x, &BTreeMap::from([("a", (0..10).collect())])), 1.0);
    }
}
