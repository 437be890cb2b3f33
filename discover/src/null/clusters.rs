//! Tests in which the runs of a session may share an error.
//!
//! With U_g the sum of a candidate's scores over the runs of session g and V the variance of all of
//! them by random effects, the null distribution is that of
//!
//! ```text
//! T* = (sum_g w_g U_g + sum_k z_k c_k) / sqrt(sum_g w_g^2 U_g^2 + V)
//! ```
//!
//! w_g are Webb's six weights, which give distinct values of T* with few sessions, and z_k is
//! standard normal: the wild cluster bootstrap of scores with the null imposed.
//!
//! Source: M. D. Webb, Reworking wild bootstrap-based inference for clustered errors, Canadian
//! Journal of Economics 56 (2023) 839; P. Kline, A. Santos, A score based approach to wild
//! bootstrap inference, Journal of Econometric Methods 1 (2012) 23.

use std::collections::{BTreeMap, HashMap};

use nalgebra::DMatrix;

use crate::null::random::{below, stream};
use crate::null::sign_flips::{MaxT, weighted_sums};

/// Members of each group, groups in the order of their names.
pub fn members<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, Vec<usize>> {
    let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, name) in names.enumerate() {
        groups.entry(name).or_default().push(i);
    }
    groups
}

/// Number of the session of each run, in the order in which they first appear.
pub fn session_numbers<'a>(sessions: impl Iterator<Item = &'a str>) -> Vec<usize> {
    let mut known: HashMap<&str, usize> = HashMap::new();
    let number = |session| {
        let next = known.len();
        *known.entry(session).or_insert(next)
    };
    sessions.map(number).collect()
}

/// The max-T p-value of each candidate over all of them; `None` with fewer than two sessions.
///
/// `u`: scores (candidates by runs). `shared`: contribution of random effects to each sum.
/// `common`: derivative of each sum by each random effect, per standard deviation (candidates by
/// random effects). `sessions`: number of each run's session. Candidates without any score are
/// excluded.
pub fn by_sessions(
    u: &DMatrix<f64>,
    shared: &[f64],
    common: &DMatrix<f64>,
    sessions: &[usize],
    (draws, seed): (usize, u64),
) -> Option<Vec<f64>> {
    let groups = sessions.iter().max().map_or(0, |last| last + 1);
    if groups < 2 {
        return None;
    }
    let mut sums = DMatrix::zeros(u.nrows(), groups);
    for (run, session) in sessions.iter().enumerate() {
        let mut own = sums.column_mut(*session);
        own += u.column(run);
    }
    let variance: Vec<f64> = common.row_iter().map(|row| row.norm_squared()).collect();
    let t = |sum: f64, squares: f64| {
        if squares > 0.0 {
            (sum / squares.sqrt()).abs()
        } else {
            0.0
        }
    };
    let webb = [-1.5_f64, -1.0, -0.5, 0.5, 1.0, 1.5].map(|w| w.signum() * w.abs().sqrt());
    let null = MaxT::drawn(draws, |k| {
        let rng = &mut stream(seed, 0xC105, k);
        let (total, squares) =
            weighted_sums(&sums, common, rng, |rng| webb[below(rng, webb.len())]);
        let each = total.iter().zip(squares.iter().zip(&variance));
        each.map(|(sum, (squares, variance))| t(*sum, squares + variance))
            .fold(0.0, f64::max)
    });
    let p_value = |c: usize| {
        let row = sums.row(c);
        null.p_value(t(row.sum() + shared[c], row.norm_squared() + variance[c]))
    };
    Some((0..u.nrows()).map(p_value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::normal;
    use crate::null::sign_flips::{MaxT, statistics};

    const RUNS: usize = 4;

    /// Share of data sets with a p-value of at most 0.01 by runs and by sessions: twenty
    /// candidates, runs of a session correlated by 0.3, the first candidate with this mean score.
    fn detected(sessions: usize, mean: f64) -> [f64; 2] {
        let numbers: Vec<usize> = (0..sessions * RUNS).map(|run| run / RUNS).collect();
        let mut rng = stream(7, 7, 7);
        let sets = 200;
        let mut found = [0.0; 2];
        for seed in 0..sets {
            let faults = DMatrix::from_fn(20, sessions, |_, _| normal(&mut rng));
            let u = DMatrix::from_fn(20, numbers.len(), |c, i| {
                let own = 0.7_f64.sqrt() * normal(&mut rng);
                own + 0.3_f64.sqrt() * faults[(c, numbers[i])] + if c == 0 { mean } else { 0.0 }
            });
            let by_runs = MaxT::by_sign_flips(&u, 399, seed);
            let t = statistics(&u);
            let shared = vec![0.0; u.nrows()];
            let none = DMatrix::zeros(u.nrows(), 0);
            let by_sessions = by_sessions(&u, &shared, &none, &numbers, (399, seed)).unwrap();
            let largest = if mean > 0.0 {
                t[0].abs()
            } else {
                t.iter().fold(0.0_f64, |m, t| m.max(t.abs()))
            };
            let least = if mean > 0.0 {
                by_sessions[0]
            } else {
                by_sessions.iter().copied().fold(1.0, f64::min)
            };
            found[0] += f64::from(u8::from(by_runs.p_value(largest) <= 0.01)) / sets as f64;
            found[1] += f64::from(u8::from(least <= 0.01)) / sets as f64;
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

    #[test]
    fn one_session_cannot_be_compared_with_others() {
        let u = DMatrix::from_element(1, 3, 1.0);
        let none = DMatrix::zeros(1, 0);
        assert!(by_sessions(&u, &[0.0], &none, &[0, 0, 0], (9, 1)).is_none());
        assert_eq!(
            session_numbers(["a", "b", "a", "c"].into_iter()),
            [0, 1, 0, 2]
        );
    }
}
