//! Randomisation tests of sizes from the [`Scores`] of independent units: runs, or sessions.
//!
//! With u_i the score of unit i, I_i its information, V the variance of the sum of scores due to
//! random effects common to all units, and random weights w_i of mean 0 and variance 1:
//!
//! ```text
//! size* = (sum w_i u_i + z) / (sum I_i + V)
//! t*    = (sum w_i u_i + z) / sqrt(n/(n - 1) sum (w_i u_i - size* I_i)^2 + V),   z ~ N(0, V)
//! ```
//!
//! The observed t has all w = 1 and the fitted random effects as z. The null hypothesis is imposed
//! on the scores, but the scatter of every draw is taken about the draw's estimate size*. If it
//! were taken about 0, an effect in all units would contribute to its own scatter, and |t| could
//! not exceed sqrt(n). Weights of runs are random signs, exact if scores are symmetric. Weights of
//! sessions are Webb's six values (wild cluster bootstrap), which give more distinct draws if there
//! are few sessions.
//!
//! Source: A. C. Cameron, J. B. Gelbach, D. L. Miller, Bootstrap-based improvements for inference
//! with clustered errors, Review of Economics and Statistics 90 (2008) 414; P. Kline, A. Santos, A
//! score based approach to wild bootstrap inference, Journal of Econometric Methods 1 (2012) 23;
//! M. D. Webb, Reworking wild bootstrap-based inference for clustered errors, Canadian Journal of
//! Economics 56 (2023) 839.

use nalgebra::{DMatrix, DVectorView};
use rand_chacha::ChaCha8Rng;

use crate::null::random::{below, sign, stream};
use crate::null::sign_flips::{MaxT, drawn};
use crate::regression::scores::Scores;

impl Scores {
    /// Scores of the selected candidates.
    pub(crate) fn only(&self, selected: &[usize]) -> Self {
        Self {
            u: self.u.select_rows(selected),
            information: self.information.select_rows(selected),
            raw: selected.iter().map(|c| self.raw[*c]).collect(),
            shared: selected.iter().map(|c| self.shared[*c]).collect(),
            common: self.common.select_rows(selected),
        }
    }

    /// Appends candidate `candidate` of other scores of the same units.
    pub(crate) fn push(&mut self, from: &Self, candidate: usize) {
        let rows = self.u.nrows();
        let appended = |to: &DMatrix<f64>, from: &DMatrix<f64>| {
            let mut appended = to.clone().insert_row(rows, 0.0);
            appended.row_mut(rows).copy_from(&from.row(candidate));
            appended
        };
        self.u = appended(&self.u, &from.u);
        self.information = appended(&self.information, &from.information);
        self.common = appended(&self.common, &from.common);
        self.shared.push(from.shared[candidate]);
        self.raw.push(from.raw[candidate]);
    }

    /// Scores with sessions as units: sums over the runs of each session; `None` with fewer than
    /// two sessions.
    ///
    /// `sessions`: number of each run's session.
    pub(crate) fn by_sessions(&self, sessions: &[usize]) -> Option<Self> {
        let groups = sessions.iter().max().map_or(0, |last| last + 1);
        let summed = |of: &DMatrix<f64>| {
            let mut sums = DMatrix::zeros(of.nrows(), groups);
            for (run, session) in sessions.iter().enumerate() {
                let mut sum = sums.column_mut(*session);
                sum += of.column(run);
            }
            sums
        };
        (groups > 1).then(|| Self {
            u: summed(&self.u),
            information: summed(&self.information),
            ..self.clone()
        })
    }

    /// Observed t of each candidate.
    pub(crate) fn t(&self) -> Vec<f64> {
        Weighted::of(self, |_| 1.0, &self.shared).studentised(&self.totals())
    }

    /// The distribution of the largest |t| with a random sign of each unit.
    pub(crate) fn by_sign_flips(&self, draws: usize, seed: u64) -> MaxT {
        self.drawn(draws, (seed, 0xF11B), sign)
    }

    /// The distribution of the largest |t| with a random one of Webb's weights for each unit.
    pub(crate) fn by_wild_bootstrap(&self, draws: usize, seed: u64) -> MaxT {
        let webb = [-1.5_f64, -1.0, -0.5, 0.5, 1.0, 1.5].map(|w| w.signum() * w.abs().sqrt());
        self.drawn(draws, (seed, 0xC105), |rng| webb[below(rng, webb.len())])
    }

    /// The distribution of the largest |t| with random weights.
    fn drawn(
        &self,
        draws: usize,
        (seed, salt): (u64, u64),
        weight: impl Fn(&mut ChaCha8Rng) -> f64 + Sync + Send,
    ) -> MaxT {
        let totals = self.totals();
        MaxT::drawn_in_blocks(draws, |draws| {
            let streams = draws.map(|k| stream(seed, salt, k));
            let counts = [self.u.ncols(), self.common.ncols()];
            let [weights, sizes] = drawn(streams, counts, &weight);
            let random = &self.common * sizes;
            let largest = |(weights, random): (DVectorView<f64>, DVectorView<f64>)| {
                let weighted = Weighted::of(self, |unit| weights[unit], random.as_slice());
                let t = weighted.studentised(&totals);
                t.into_iter().fold(0.0, |most: f64, t| most.max(t.abs()))
            };
            weights
                .column_iter()
                .zip(random.column_iter())
                .map(largest)
                .collect()
        })
    }

    /// Totals of the information about each candidate.
    fn totals(&self) -> Vec<Totals> {
        let of = |c: usize| {
            let information = self.information.row(c);
            Totals {
                units: information.iter().filter(|i| **i > 0.0).count() as f64,
                information: self.total_information(c),
                squares: information.norm_squared(),
                variance: self.shared_variance(c),
            }
        };
        (0..self.u.nrows()).map(of).collect()
    }

    /// t of candidate `a` minus `share` times candidate `b`, with the scatter taken about 0.
    pub(crate) fn t_of_difference(&self, a: usize, b: usize, share: f64) -> f64 {
        let difference = self.u.row(a) - self.u.row(b) * share;
        let common = self.common.row(a) - self.common.row(b) * share;
        let sum = difference.sum() + self.shared[a] - share * self.shared[b];
        let norm = (difference.norm_squared() + common.norm_squared()).sqrt();
        if norm > 0.0 { sum / norm } else { 0.0 }
    }
}

/// Sums of the information about a candidate's size, which do not depend on weights.
struct Totals {
    /// Number of units with information.
    units: f64,
    /// Sum of the units' information and of V.
    information: f64,
    /// Sum of the squares of the units' information.
    squares: f64,
    /// Variance V of the sum of scores due to random effects.
    variance: f64,
}

/// Sums over units, by candidate: of weighted scores, of their squares, and of their products with
/// the information.
struct Weighted {
    sums: Vec<f64>,
    squares: Vec<f64>,
    crossed: Vec<f64>,
}

impl Weighted {
    fn of(scores: &Scores, weight: impl Fn(usize) -> f64, random: &[f64]) -> Self {
        let count = scores.u.nrows();
        let mut all = Self {
            sums: random.to_vec(),
            squares: vec![0.0; count],
            crossed: vec![0.0; count],
        };
        for unit in 0..scores.u.ncols() {
            let (weight, information) = (weight(unit), scores.information.column(unit));
            for (c, score) in scores.u.column(unit).iter().enumerate() {
                let weighted = weight * score;
                all.sums[c] += weighted;
                all.squares[c] += weighted * weighted;
                all.crossed[c] += weighted * information[c];
            }
        }
        all
    }

    /// t of each candidate; 0 if fewer than two units have information.
    fn studentised(&self, totals: &[Totals]) -> Vec<f64> {
        let of = |(c, of): (usize, &Totals)| {
            if of.units < 2.0 || of.information <= 0.0 {
                return 0.0;
            }
            let [sum, squares, crossed] =
                [&self.sums, &self.squares, &self.crossed].map(|sums| sums[c]);
            let size = sum / of.information;
            let scatter = squares - 2.0 * size * crossed + size * size * of.squares;
            let variance = of.units / (of.units - 1.0) * scatter.max(0.0) + of.variance;
            sum / variance.sqrt().max(f64::MIN_POSITIVE)
        };
        totals.iter().enumerate().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::clusters::session_numbers;
    use crate::null::random::normal;

    const RUNS: usize = 4;

    /// Scores of twenty candidates in sessions of four runs. Runs of a session are correlated by
    /// 0.3; the first candidate has this mean score per information.
    fn drawn(sessions: usize, mean: f64, rng: &mut ChaCha8Rng) -> Scores {
        let faults = DMatrix::from_fn(20, sessions, |_, _| normal(rng));
        let information = DMatrix::from_fn(
            20,
            sessions * RUNS,
            |_, i| if i % 3 == 0 { 2.0 } else { 0.5 },
        );
        let u = DMatrix::from_fn(20, sessions * RUNS, |c, i| {
            let own = 0.7_f64.sqrt() * normal(rng) + 0.3_f64.sqrt() * faults[(c, i / RUNS)];
            let of_effect = if c == 0 { mean } else { 0.0 };
            f64::sqrt(information[(c, i)]) * own + information[(c, i)] * of_effect
        });
        Scores {
            u,
            information,
            raw: vec![0.0; 20],
            shared: vec![0.0; 20],
            common: DMatrix::zeros(20, 0),
        }
    }

    /// Share of data sets in which the first or, without an effect, any candidate has a p-value of
    /// at most 0.01 by runs and by sessions.
    fn detected(sessions: usize, mean: f64) -> [f64; 2] {
        let numbers: Vec<usize> = (0..sessions * RUNS).map(|run| run / RUNS).collect();
        let mut rng = stream(7, 7, 7);
        let sets = 200;
        let mut found = [0.0; 2];
        for seed in 0..sets {
            let by_runs = drawn(sessions, mean, &mut rng);
            let of_sessions = by_runs.by_sessions(&numbers).expect("sessions");
            let tests = [
                (by_runs.t(), by_runs.by_sign_flips(399, seed)),
                (of_sessions.t(), of_sessions.by_wild_bootstrap(399, seed)),
            ];
            for (found, (t, null)) in found.iter_mut().zip(tests) {
                let most = t.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
                let t = if mean > 0.0 { t[0].abs() } else { most };
                *found += f64::from(u8::from(null.p_value(t) <= 0.01)) / sets as f64;
            }
        }
        found
    }

    /// Binomial with 200 trials at 0.01: mean 2, three deviations 4.2.
    #[test]
    fn errors_shared_by_sessions_are_significant_by_runs_and_not_by_sessions() {
        let [by_runs, by_sessions] = detected(12, 0.0);
        assert!(by_runs > 0.05, "{by_runs}");
        assert!(by_sessions <= 0.031, "{by_sessions}");
    }

    #[test]
    fn an_effect_in_twelve_sessions_is_significant_by_both() {
        let found = detected(12, 2.0);
        assert!(found.iter().all(|share| *share > 0.9), "{found:?}");
    }

    /// |t| about 0 of twelve runs is at most 3.5, which the largest of twenty candidates reaches.
    #[test]
    fn a_large_effect_in_a_few_unequal_runs_is_significant() {
        let found = detected(3, 30.0);
        assert!(found[0] > 0.9, "{found:?}");
    }

    #[test]
    fn t_is_that_of_weighted_least_squares_with_a_robust_error() {
        let scores = Scores {
            raw: vec![4.0],
            u: DMatrix::from_row_slice(1, 3, &[2.0, 1.0, 4.0]),
            information: DMatrix::from_row_slice(1, 3, &[1.0, 0.5, 1.5]),
            shared: vec![0.0],
            common: DMatrix::zeros(1, 0),
        };
        // size 7/3; residuals 2 - 7/3, 1 - 7/6, 4 - 7/2
        let square: f64 = [-1.0 / 3.0, -1.0 / 6.0, 0.5_f64]
            .iter()
            .map(|r| r * r)
            .sum();
        assert!((scores.t()[0] - 7.0 / f64::sqrt(1.5 * square)).abs() < 1e-12);
    }

    #[test]
    fn one_session_cannot_be_compared_with_others() {
        let scores = drawn(1, 0.0, &mut stream(1, 1, 1));
        assert!(scores.by_sessions(&[0; 4]).is_none());
        assert_eq!(
            session_numbers(["a", "b", "a", "c"].into_iter()),
            [0, 1, 0, 2]
        );
    }
}
