//! Regression of the levels of friction and grip of sessions and runs on weather and order.

use std::collections::BTreeMap;

use kufe_sled::correlation;
use kufe_sled::effects::Level;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::noise_products::noise_products;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::recordings::frame::Frame;
use crate::null::clusters::members;
use crate::null::permutations::by_session_permutation;
use crate::null::random::{shuffle, stream};
use crate::null::sign_flips::MaxT;
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
    pub scores: Vec<LevelScore>,
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
    let RunLevels {
        levels,
        weights,
        changes,
    } = run_levels(design, frames, simulator, q);
    let explained = |c: usize, k: usize| -> f64 {
        let runs = changes[c].iter().zip(&weights);
        runs.map(|(z, weight)| z[k] * z[k] * weight[k]).sum()
    };
    let level_of = (0..q).map(|c| usize::from(explained(c, 1) > explained(c, 0)));
    let level_of: Vec<usize> = level_of.collect();
    let of_level = |runs: &[[f64; OWN_LEVELS]], k: usize| runs.iter().map(|l| l[k]).collect();
    let levels: [Vec<f64>; OWN_LEVELS] = [0, 1].map(|k| of_level(&levels, k));
    let covariates = level_of.iter().zip(&changes);
    let covariates: Vec<Vec<f64>> = covariates.map(|(k, runs)| of_level(runs, *k)).collect();
    let sessions = group(frames);
    let means = levels.each_ref().map(|x| session_means(x, &sessions));
    let of_sessions = covariates.iter().map(|x| session_means(x, &sessions));
    let of_sessions: Vec<Vec<f64>> = of_sessions.collect();
    let untested = LevelScore {
        correlation: 0.0,
        p_value: 1.0,
        size: 0.0,
        error: f64::INFINITY,
        gain: 0.0,
    };
    let mut scores = vec![untested; q];
    for k in 0..OWN_LEVELS {
        let acting = |level: Level| -> Vec<usize> {
            let acts = |c: &usize| level_of[*c] == k && candidates[*c].act.level == level;
            (0..q).filter(acts).collect()
        };
        let weight: f64 = weights.iter().map(|w| w[k]).sum();
        let mut score = |tested: &[usize], y: &[f64], xs: &[Vec<f64>], p_values: Vec<f64>| {
            let weight = weight / y.len() as f64;
            for ((c, x), p_value) in tested.iter().zip(xs).zip(p_values) {
                let slope = slope(y, x, candidates[*c].typical, weight);
                scores[*c] = LevelScore { p_value, ..slope };
            }
        };
        let tested = acting(Level::Session);
        if !tested.is_empty() && means[k].len() >= 3 {
            let xs: Vec<Vec<f64>> = tested.iter().map(|c| of_sessions[*c].clone()).collect();
            let permuted = by_session_permutation(&means[k], &xs, 3999, seed);
            let p_values = permuted.into_iter().map(|(_, p)| p).collect();
            score(&tested, &means[k], &xs, p_values);
        }
        let tested = acting(Level::Run);
        if let Some(first) = tested.first() {
            let y = within(&levels[k], &sessions);
            let xs = tested.iter().map(|c| within(&covariates[*c], &sessions));
            let xs: Vec<Vec<f64>> = xs.collect();
            let p_values = by_permutation_in_sessions(&y, &xs, &sessions, (seed, *first as u64));
            score(&tested, &y, &xs, p_values);
        }
    }
    LevelScreen {
        scores,
        sessions: sessions.len(),
        sessions_differ: levels.each_ref().map(|x| f_test(x, &sessions)),
        covariates: of_sessions,
        level_of,
        means,
    }
}

/// Levels of friction and grip of each run.
struct RunLevels {
    levels: Vec<[f64; OWN_LEVELS]>,
    /// Information about each level.
    weights: Vec<[f64; OWN_LEVELS]>,
    /// Change of the levels of each run by each candidate.
    changes: Vec<Vec<[f64; OWN_LEVELS]>>,
}

/// Levels of each run by least squares, corrected for noisy inputs, and their changes by `count`
/// candidates.
fn run_levels(
    design: &Design,
    frames: &[Frame],
    simulator: &RunSimulator,
    count: usize,
) -> RunLevels {
    let first = OWN_LEVELS + design.fitted_count();
    let mut runs = RunLevels {
        levels: Vec::new(),
        weights: Vec::new(),
        changes: vec![Vec::new(); count],
    };
    let products = design.products(frames);
    let noise = noise_products(design, frames, simulator, 6_000_029);
    for (products, noise) in products.iter().zip(&noise) {
        let matrix = &products.full - noise;
        let square = matrix.view((0, 0), (OWN_LEVELS, OWN_LEVELS)).into_owned();
        let inverse = ridge_inverse(square.clone());
        let level_of_column = |k: usize| -> [f64; OWN_LEVELS] {
            let level = &inverse * matrix.view((0, k), (OWN_LEVELS, 1)).column(0);
            [level[0], level[1]]
        };
        runs.levels.push(level_of_column(matrix.ncols() - 1));
        runs.weights.push([square[(0, 0)], square[(1, 1)]]);
        for (c, changes) in runs.changes.iter_mut().enumerate() {
            changes.push(level_of_column(first + c));
        }
    }
    runs
}

/// p-values of the correlation of values with each covariate, by permutation of the runs within
/// their sessions. The largest correlation of all covariates is compared, which corrects for their
/// number (max-T).
fn by_permutation_in_sessions(
    y: &[f64],
    covariates: &[Vec<f64>],
    sessions: &BTreeMap<&str, Vec<usize>>,
    (seed, purpose): (u64, u64),
) -> Vec<f64> {
    let null = MaxT::drawn(1999, |trial| {
        let mut rng = stream(seed, 0x0BDE + purpose, trial);
        let mut permuted = y.to_vec();
        for runs in sessions.values() {
            let mut order = runs.clone();
            shuffle(&mut rng, &mut order);
            for (to, from) in runs.iter().zip(&order) {
                permuted[*to] = y[*from];
            }
        }
        let each = covariates.iter().map(|x| correlation(&permuted, x).abs());
        each.fold(0.0, f64::max)
    });
    let p_value = |x: &Vec<f64>| null.p_value(correlation(y, x));
    covariates.iter().map(p_value).collect()
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
            return self.scores[a].size / self.scores[a].error.max(1e-300);
        }
        let y = centred(&self.means[self.level_of[a]]);
        let (x, z) = (centred(&self.covariates[a]), centred(&self.covariates[b]));
        let zz: f64 = dot(&z, &z).max(1e-300);
        let free = |v: &[f64]| -> Vec<f64> {
            let share = dot(v, &z) / zz;
            v.iter().zip(&z).map(|(v, z)| v - share * z).collect()
        };
        let total = dot(&x, &x);
        let (y, x) = (free(&y), free(&x));
        let xx = dot(&x, &x);
        if xx < 1e-9 * total {
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

/// Mean of each session.
pub fn session_means(x: &[f64], sessions: &BTreeMap<&str, Vec<usize>>) -> Vec<f64> {
    let mean = |runs: &Vec<usize>| runs.iter().map(|i| x[*i]).sum::<f64>() / runs.len() as f64;
    sessions.values().map(mean).collect()
}

/// Values minus the mean of their session.
fn within(x: &[f64], sessions: &BTreeMap<&str, Vec<usize>>) -> Vec<f64> {
    let mut out = x.to_vec();
    for (runs, mean) in sessions.values().zip(session_means(x, sessions)) {
        runs.iter().for_each(|i| out[*i] -= mean);
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
    let residuals = yc.iter().zip(&xc).map(|(y, x)| y - size * x);
    let rest: f64 = residuals.map(|r| r.powi(2)).sum();
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
