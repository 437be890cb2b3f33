//! One screen of all candidates: t of each beside the chosen ones, and what chance makes of the largest.

use nalgebra::DVector;

use crate::evidence::experiments::candidates::{FrictionChange, sessions};
use crate::evidence::experiments::fit::{Setting, fit};
use crate::evidence::experiments::rows::Row;
use crate::finding::Detectable;
use crate::null::gumbel::gumbel_tail;
use crate::null::random::{normal, shuffle, stream};
use crate::options::Options;
use crate::procedure::beside::{Amount, Chance};
use crate::procedure::candidate::Candidate;
use crate::procedure::rules::ExperimentRules;
use crate::regression::inverse::ridge_inverse;

/// What a screen shows.
pub struct TableScreen {
    /// t of each candidate.
    pub t: Vec<f64>,
    /// Size of each, in units of `typical`.
    pub size: Vec<f64>,
    /// Standard error of each, in units of `typical`.
    pub error: Vec<f64>,
    left: Vec<f64>,
    free: Vec<DVector<f64>>,
    simulated: Vec<f64>,
    permuted: Vec<f64>,
    permuted_sessions: Vec<f64>,
    by_session: Vec<bool>,
    critical: f64,
    nine_in_ten: f64,
    rules: ExperimentRules,
}

impl TableScreen {
    /// The larger of the p-values by permutation and against twins, over all candidates.
    pub fn p_value(&self, c: usize) -> f64 {
        let t = self.t[c].abs();
        let null = if self.by_session[c] {
            &self.permuted_sessions
        } else {
            &self.permuted
        };
        let above = null.iter().filter(|m| **m >= t - 1e-9).count();
        let by_permutation = (above + 1) as f64 / (null.len() + 1) as f64;
        by_permutation.max(gumbel_tail(&self.simulated, t))
    }

    /// The one with the largest |t| of those that are not chosen.
    pub fn largest(&self, chosen: &[usize]) -> Option<usize> {
        (0..self.t.len())
            .filter(|c| !chosen.contains(c) && self.t[*c].is_finite())
            .max_by(|a, b| self.t[*a].abs().total_cmp(&self.t[*b].abs()))
    }

    /// Whether it stands out, beyond the base and within its bounds.
    pub fn claimable(&self, c: usize, candidate: &Candidate<FrictionChange>) -> bool {
        self.left[c] > self.rules.least_left
            && self.p_value(c) <= self.rules.alpha
            && candidate.admits(self.size[c] * candidate.typical)
    }

    /// What it shows of every effect by name that is not chosen.
    pub fn chances(
        &self,
        candidates: &[Candidate<FrictionChange>],
        chosen: &[usize],
    ) -> Vec<Chance> {
        let named = candidates.iter().enumerate();
        let named = named.filter(|(c, candidate)| {
            let judged = self.left[*c] > self.rules.least_left && !chosen.contains(c);
            judged && !candidate.is_column() && candidate.admits(self.size[*c] * candidate.typical)
        });
        named
            .map(|(c, candidate)| {
                let value = self.size[c] * candidate.typical;
                Chance {
                    // With the scatter that its t is judged by.
                    amount: Amount::of(candidate, value, (value / self.t[c]).abs()),
                    p_value: self.p_value(c),
                }
            })
            .filter(|chance| chance.amount.error.is_finite())
            .collect()
    }

    /// Cosine of two candidates beyond the base.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let norm = self.free[a].norm() * self.free[b].norm();
        if norm > 0.0 {
            self.free[a].dot(&self.free[b]) / norm
        } else {
            0.0
        }
    }

    /// The smallest sizes that would be claimed nine times in ten.
    pub fn detectable(&self, candidates: &[Candidate<FrictionChange>]) -> Vec<Detectable> {
        (0..candidates.len())
            .map(|c| {
                let like = (0..candidates.len())
                    .filter(|j| {
                        !candidates[*j].is_column() && candidates[*j].effect != candidates[c].effect
                    })
                    .max_by(|a, b| {
                        self.correlation(c, *a)
                            .abs()
                            .total_cmp(&self.correlation(c, *b).abs())
                    });
                Detectable {
                    effect: candidates[c].effect.clone(),
                    parameter: candidates[c].key.clone(),
                    size: (self.critical + self.nine_in_ten)
                        * self.error[c]
                        * candidates[c].typical,
                    unit: candidates[c].unit.clone(),
                    left_after_refit: self.left[c],
                    most_like: like.map_or(String::new(), |j| candidates[j].effect.clone()),
                    correlation: like.map_or(0.0, |j| self.correlation(c, j)),
                }
            })
            .collect()
    }
}

/// t of every candidate added to the chosen ones, and the nulls of the largest.
pub fn screen_table(
    setting: &Setting,
    rows: &[Row],
    chosen: &[usize],
    options: &Options,
) -> TableScreen {
    let (candidates, base) = (&setting.candidates, setting.base);
    let rules = options.rules.experiments;
    let now = fit(setting, rows, chosen);
    let n = rows.len();
    let inverse = ridge_inverse(now.columns.tr_mul(&now.columns));
    let project = |x: &DVector<f64>| -> DVector<f64> {
        x - &now.columns * (&inverse * now.columns.tr_mul(x))
    };
    let whitened = |c: usize| -> DVector<f64> {
        now.whitening.apply(&DVector::from_fn(n, |i, _| {
            let (mu, _) = now.predict(setting, &rows[i], chosen);
            candidates[c].slope(&rows[i], mu.max(1e-5), 0.0)
        }))
    };
    let raw: Vec<DVector<f64>> = (0..candidates.len()).map(whitened).collect();
    let free: Vec<DVector<f64>> = raw.iter().map(&project).collect();
    let left: Vec<f64> = raw
        .iter()
        .zip(&free)
        .map(|(r, f)| f.norm_squared() / r.norm_squared().max(1e-300))
        .collect();
    let freedom = (n as f64 - base as f64 - chosen.len() as f64 - 1.0).max(1.0);
    // Errors are scaled up by what is left where the rows scatter more than stated, never down.
    let t_of = |rest: &DVector<f64>, c: usize| -> f64 {
        if left[c] <= rules.least_left || chosen.contains(&c) {
            return 0.0;
        }
        let norm = free[c].norm();
        let score = free[c].dot(rest) / norm;
        let excess = ((rest.norm_squared() - score * score) / freedom).max(1.0);
        score / excess.sqrt()
    };
    let all = |rest: &DVector<f64>| -> Vec<f64> {
        (0..candidates.len()).map(|c| t_of(rest, c)).collect()
    };
    let largest = |rest: &DVector<f64>, only_sessions: bool| -> f64 {
        (0..candidates.len())
            .filter(|c| !only_sessions || candidates[*c].act.by_session)
            .map(|c| t_of(rest, c).abs())
            .fold(0.0, f64::max)
    };
    let t = all(&now.rest);
    let permuted = (0..options.flips)
        .map(|k| {
            let mut order: Vec<usize> = (0..n).collect();
            shuffle(&mut stream(options.seed, 0x9E12, k as u64), &mut order);
            largest(
                &project(&DVector::from_fn(n, |i, _| now.rest[order[i]])),
                false,
            )
        })
        .collect();
    let sessions = sessions(rows);
    let permuted_sessions = (0..options.flips)
        .map(|k| {
            let mut order: Vec<usize> = (0..sessions.len()).collect();
            shuffle(&mut stream(options.seed, 0x9E13, k as u64), &mut order);
            // A session takes the mean residual of another one and keeps its own scatter.
            let mean: Vec<f64> = sessions
                .iter()
                .map(|s| {
                    let own: Vec<f64> = (0..n)
                        .filter(|i| rows[*i].session == *s)
                        .map(|i| now.rest[i])
                        .collect();
                    own.iter().sum::<f64>() / own.len() as f64
                })
                .collect();
            let mixed = DVector::from_fn(n, |i, _| {
                let at = sessions
                    .iter()
                    .position(|s| *s == rows[i].session)
                    .unwrap_or(0);
                now.rest[i] - mean[at] + mean[order[at]]
            });
            largest(&project(&mixed), true)
        })
        .collect();
    let mut specimens: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    specimens.sort_unstable();
    specimens.dedup();
    let simulated: Vec<f64> = (0..options.twins.max(40))
        .map(|k| {
            let mut rng = stream(options.seed, 0x7A17, k);
            let offsets: Vec<f64> = specimens
                .iter()
                .map(|_| setting.between * normal(&mut rng))
                .collect();
            let twin: Vec<Row> = rows
                .iter()
                .map(|row| {
                    let mut twin = row.clone();
                    let specimen = specimens.iter().position(|name| *name == row.name);
                    let offset = specimen.map_or(0.0, |k| offsets[k]);
                    let (_, mu) = now.predict(setting, row, chosen);
                    twin.mu = mu + offset + row.mu_sd * normal(&mut rng);
                    twin.pressure = row.pressure + row.pressure_sd * normal(&mut rng);
                    twin
                })
                .collect();
            let refit = fit(setting, &twin, chosen);
            largest(&project(&refit.rest), false)
        })
        .collect();
    let mut order = simulated.clone();
    order.sort_by(f64::total_cmp);
    let critical = order[((1.0 - rules.alpha) * order.len() as f64) as usize % order.len()];
    TableScreen {
        size: (0..candidates.len())
            .map(|c| free[c].dot(&now.rest) / free[c].norm_squared().max(1e-300))
            .collect(),
        error: free.iter().map(|f| 1.0 / f.norm().max(1e-300)).collect(),
        by_session: candidates.iter().map(|c| c.act.by_session).collect(),
        t,
        left,
        free,
        simulated,
        permuted,
        permuted_sessions,
        critical,
        nine_in_ten: options.rules.search.nine_in_ten,
        rules,
    }
}
