//! One screen of all candidates: t of each and the null distribution of the largest |t|.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::fit::{Setting, fit};
use crate::evidence::experiments::rows::Row;
use crate::finding::Detectable;
use crate::null::clusters::members;
use crate::null::gumbel::gumbel_tail;
use crate::null::random::{normal, shuffle, stream};
use crate::options::Options;
use crate::procedure::candidate::Candidate;
use crate::procedure::rules::ExperimentRules;
use crate::procedure::shared_effects::{Amount, ScreenEstimate};
use crate::regression::inverse::ridge_inverse;

/// Scores of a screen.
pub struct TableScreen {
    /// t of each candidate.
    pub t: Vec<f64>,
    /// Size of each, in units of `typical`.
    pub size: Vec<f64>,
    /// Standard error of each, in units of `typical`.
    pub error: Vec<f64>,
    remaining_share: Vec<f64>,
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
    /// The larger of the max-T p-values by permutation and by simulated tables.
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

    /// The candidate of largest |t| that is not in the model.
    pub fn largest(&self, chosen: &[usize]) -> Option<usize> {
        (0..self.t.len())
            .filter(|c| !chosen.contains(c) && self.t[*c].is_finite())
            .max_by(|a, b| self.t[*a].abs().total_cmp(&self.t[*b].abs()))
    }

    /// Whether a candidate is admissible: it can be judged and its size is within bounds.
    pub fn is_selectable(&self, c: usize, candidate: &Candidate<FrictionChange>) -> bool {
        self.remaining_share[c] > self.rules.least_left
            && self.p_value(c) <= self.rules.alpha
            && candidate.admits(self.size[c] * candidate.typical)
    }

    /// Estimate and p-value of every named effect that is not in the model.
    pub fn screen_estimates(
        &self,
        candidates: &[Candidate<FrictionChange>],
        chosen: &[usize],
    ) -> Vec<ScreenEstimate> {
        let named = candidates.iter().enumerate();
        let named = named.filter(|(c, candidate)| {
            let judged = self.remaining_share[*c] > self.rules.least_left && !chosen.contains(c);
            judged && !candidate.is_column() && candidate.admits(self.size[*c] * candidate.typical)
        });
        named
            .map(|(c, candidate)| {
                let value = self.size[c] * candidate.typical;
                ScreenEstimate {
                    // The standard error includes the scatter that t is computed with.
                    amount: Amount::of(candidate, value, (value / self.t[c]).abs()),
                    p_value: self.p_value(c),
                }
            })
            .filter(|chance| chance.amount.error.is_finite())
            .collect()
    }

    /// Cosine of two candidates after projection on the complement of the base.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let norm = self.free[a].norm() * self.free[b].norm();
        if norm > 0.0 {
            self.free[a].dot(&self.free[b]) / norm
        } else {
            0.0
        }
    }

    /// Smallest sizes that would be selected with a probability of 90 %.
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
                    left_after_refit: self.remaining_share[c],
                    most_like: like.map_or(String::new(), |j| candidates[j].effect.clone()),
                    correlation: like.map_or(0.0, |j| self.correlation(c, j)),
                }
            })
            .collect()
    }
}

/// t of every candidate added to the model, and null distributions of the largest |t|.
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
    let remaining_share: Vec<f64> = raw
        .iter()
        .zip(&free)
        .map(|(r, f)| f.norm_squared() / r.norm_squared().max(1e-300))
        .collect();
    let freedom = (n as f64 - base.len() as f64 - chosen.len() as f64 - 1.0).max(1.0);
    let judged = |c: usize| remaining_share[c] > rules.least_left && !chosen.contains(&c);
    let units = Units::new(&free, judged, &now.columns, inverse, freedom);
    let t = units.all(
        &units.products(now.rest.iter().copied()),
        now.rest.norm_squared(),
    );
    let permuted = (0..options.flips)
        .into_par_iter()
        .map(|k| {
            let mut order: Vec<usize> = (0..n).collect();
            shuffle(&mut stream(options.seed, 0x9E12, k as u64), &mut order);
            let products = units.products(order.iter().map(|i| now.rest[*i]));
            units.largest(&products, now.rest.norm_squared(), |_| true)
        })
        .collect();
    let by_session: Vec<bool> = candidates.iter().map(|c| c.act.by_session).collect();
    let permuted_sessions = match by_session.contains(&true) {
        true => units.by_sessions(&by_session, rows, &now.rest, options),
        false => Vec::new(),
    };
    let specimens = members(rows.iter().map(|row| row.name.as_str()));
    let mut drawn = rows.to_vec();
    let simulated: Vec<f64> = (0..options.twins.max(40))
        .map(|k| {
            let mut rng = stream(options.seed, 0x7A17, k);
            let mut offsets = vec![0.0; n];
            for own in specimens.values() {
                let offset = setting.between * normal(&mut rng);
                own.iter().for_each(|i| offsets[*i] = offset);
            }
            for ((drawn_row, row), offset) in drawn.iter_mut().zip(rows).zip(offsets) {
                let (_, mu) = now.predict(setting, row, chosen);
                drawn_row.mu = mu + offset + row.mu_sd * normal(&mut rng);
                drawn_row.pressure = row.pressure + row.pressure_sd * normal(&mut rng);
            }
            let rest = fit(setting, &drawn, chosen).rest;
            let products = units.products(rest.iter().copied());
            units.largest(&products, rest.norm_squared(), |_| true)
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
        by_session,
        t,
        remaining_share,
        free,
        simulated,
        permuted,
        permuted_sessions,
        critical,
        nine_in_ten: options.rules.search.nine_in_ten,
        rules,
    }
}

/// Unit directions of the candidates and the base's columns, with which t of a residual is
/// computed.
///
/// With d a candidate's unit direction after projection, C the base's columns and x a residual of n
/// rows,
///
/// ```text
/// score = d'x        |x'|^2 = x'x - x'C (C'C)^-1 C'x        t = score / sqrt(max(1, (|x'|^2 - score^2) / freedom))
/// ```
///
/// A residual costs its products with these columns. Errors are scaled up if the rows scatter more
/// than stated, never down.
struct Units {
    /// Candidates, then columns of the base, by row; 0 for a candidate that cannot be judged.
    by_row: DMatrix<f64>,
    candidates: usize,
    inverse: DMatrix<f64>,
    freedom: f64,
}

impl Units {
    fn new(
        free: &[DVector<f64>],
        judged: impl Fn(usize) -> bool,
        base: &DMatrix<f64>,
        inverse: DMatrix<f64>,
        freedom: f64,
    ) -> Self {
        let (n, candidates) = (base.nrows(), free.len());
        let scale: Vec<f64> = (0..candidates)
            .map(|c| if judged(c) { 1.0 / free[c].norm() } else { 0.0 })
            .collect();
        let value = |k: usize, i: usize| match k < candidates {
            true if scale[k] == 0.0 => 0.0,
            true => scale[k] * free[k][i],
            false => base[(i, k - candidates)],
        };
        Self {
            by_row: DMatrix::from_fn(candidates + base.ncols(), n, value),
            candidates,
            inverse,
            freedom,
        }
    }

    /// Products of a residual with all columns.
    fn products(&self, rest: impl Iterator<Item = f64>) -> DVector<f64> {
        let mut sums = DVector::zeros(self.by_row.nrows());
        for (row, x) in self.by_row.column_iter().zip(rest) {
            sums.axpy(x, &row, 1.0);
        }
        sums
    }

    /// Sum of squares of a residual after projection on the complement of the base.
    fn projected_squares(&self, products: &DVector<f64>, squares: f64) -> f64 {
        let base = products.rows(self.candidates, self.inverse.nrows());
        squares - base.dot(&(&self.inverse * base))
    }

    fn t(&self, score: f64, squares: f64) -> f64 {
        let excess = ((squares - score * score) / self.freedom).max(1.0);
        score / excess.sqrt()
    }

    /// t of every candidate; `squares` is the sum of squares of the projected residual.
    fn all(&self, products: &DVector<f64>, squares: f64) -> Vec<f64> {
        let scores = products.rows(0, self.candidates);
        scores.iter().map(|score| self.t(*score, squares)).collect()
    }

    /// The largest |t| of some candidates.
    fn largest(
        &self,
        products: &DVector<f64>,
        squares: f64,
        wanted: impl Fn(usize) -> bool,
    ) -> f64 {
        let squares = self.projected_squares(products, squares);
        (0..self.candidates)
            .filter(|c| wanted(*c))
            .map(|c| self.t(products[c], squares).abs())
            .fold(0.0, f64::max)
    }

    /// The largest |t| of the session-level candidates when each session takes the mean residual of
    /// another one and keeps its own scatter. Products are sums over sessions.
    fn by_sessions(
        &self,
        by_session: &[bool],
        rows: &[Row],
        rest: &DVector<f64>,
        options: &Options,
    ) -> Vec<f64> {
        let sessions: Vec<Vec<usize>> = members(rows.iter().map(|row| row.session.as_str()))
            .into_values()
            .collect();
        let mean = |own: &Vec<usize>| own.iter().map(|i| rest[*i]).sum::<f64>() / own.len() as f64;
        let means: Vec<f64> = sessions.iter().map(mean).collect();
        let mut sums = DMatrix::zeros(self.by_row.nrows(), sessions.len());
        let mut scatter = rest.clone();
        for (s, own) in sessions.iter().enumerate() {
            for i in own {
                let mut sum = sums.column_mut(s);
                sum += self.by_row.column(*i);
                scatter[*i] -= means[s];
            }
        }
        let within = self.products(scatter.iter().copied());
        let squares_within = scatter.norm_squared();
        (0..options.flips)
            .into_par_iter()
            .map(|k| {
                let mut order: Vec<usize> = (0..sessions.len()).collect();
                shuffle(&mut stream(options.seed, 0x9E13, k as u64), &mut order);
                let levels = DVector::from_fn(order.len(), |s, _| means[order[s]]);
                let products = &within + &sums * &levels;
                let of_levels = sessions.iter().zip(levels.iter());
                let of_levels = of_levels.map(|(own, level)| own.len() as f64 * level * level);
                let squares = squares_within + of_levels.sum::<f64>();
                self.largest(&products, squares, |c| by_session[c])
            })
            .collect()
    }
}
