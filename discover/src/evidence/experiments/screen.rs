//! One screen of all candidates: t of each and the null distribution of the largest |t|.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::evidence::experiments::fit::{Fit, Setting, fit};
use crate::evidence::experiments::rows::Row;
use crate::finding::Detectable;
use crate::null::clusters::members;
use crate::null::gumbel::gumbel_tail;
use crate::null::random::{normal, shuffle, stream};
use crate::null::sign_flips::MaxT;
use crate::options::Options;
use crate::procedure::shared_effects::{Amount, ScreenEstimate};
use crate::regression::inverse::ridge_inverse;

/// Smallest number of simulated tables.
const MIN_TABLES: u64 = 40;

/// Scores of a screen.
pub struct TableScreen<'a> {
    pub setting: &'a Setting,
    pub rows: &'a [Row],
    /// The fit to which candidates are added.
    pub fit: Fit,
    pub scores: Vec<Score>,
    /// t at which a candidate is selected with a probability of 90 %.
    detectable_t: f64,
}

/// A candidate added to a fit.
pub struct Score {
    pub t: f64,
    /// Size in the unit of the candidate.
    pub size: f64,
    /// Standard error of the size, with deviations as stated.
    pub error: f64,
    /// Max-T p-value: by permutation of sessions for a candidate that differs mainly between them,
    /// else the larger of the p-values by permutation of rows and by simulated tables.
    pub p_value: f64,
    remaining_share: f64,
    /// Whether its size is within its bounds, and enough of it remains after a refit of the base.
    pub is_admissible: bool,
    /// Whitened column after projection on the complement of the base.
    free: DVector<f64>,
}

impl TableScreen<'_> {
    /// The candidate of largest |t| that is not in the model.
    pub fn largest(&self) -> Option<usize> {
        let t = |c: &usize| self.scores[*c].t.abs();
        (0..self.scores.len())
            .filter(|c| !self.fit.chosen.contains(c) && t(c).is_finite())
            .max_by(|a, b| t(a).total_cmp(&t(b)))
    }

    /// Estimate and p-value of every named effect that is not in the model.
    pub fn screen_estimates(&self) -> Vec<ScreenEstimate> {
        let named = self.setting.candidates.iter().zip(&self.scores);
        named
            .filter(|(candidate, score)| score.is_admissible && !candidate.is_column())
            .map(|(candidate, score)| ScreenEstimate {
                // The standard error includes the scatter that t is computed with.
                amount: Amount::of(candidate, score.size, (score.size / score.t).abs()),
                p_value: score.p_value,
            })
            .filter(|chance| chance.amount.error.is_finite())
            .collect()
    }

    /// Cosine of two candidates after projection on the complement of the base.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let [a, b] = [a, b].map(|c| &self.scores[c].free);
        let norm = a.norm() * b.norm();
        if norm > 0.0 { a.dot(b) / norm } else { 0.0 }
    }

    /// Smallest sizes that would be selected with a probability of 90 %.
    pub fn detectable(&self) -> Vec<Detectable> {
        let candidates = &self.setting.candidates;
        let of = |(c, score): (usize, &Score)| {
            let others = candidates.iter().enumerate();
            let named = others
                .filter(|(_, other)| !other.is_column() && other.effect != candidates[c].effect)
                .map(|(j, other)| (other, self.correlation(c, j)));
            let size = self.detectable_t * score.error;
            candidates[c].detectable(size, score.remaining_share, named)
        };
        self.scores.iter().enumerate().map(of).collect()
    }
}

/// t of every candidate added to the model, and null distributions of the largest |t|.
pub fn screen_table<'a>(
    setting: &'a Setting,
    rows: &'a [Row],
    now: Fit,
    options: &Options,
) -> TableScreen<'a> {
    let candidates = &setting.candidates;
    let rules = options.rules.experiments;
    let n = rows.len();
    let inverse = ridge_inverse(now.columns.tr_mul(&now.columns));
    let whitened = |c: usize| -> DVector<f64> {
        now.whitening.apply(&DVector::from_fn(n, |i, _| {
            let mu = now.base_law(setting, &rows[i]);
            candidates[c].slope(&rows[i], mu.max(1e-5), 0.0)
        }))
    };
    let raw: Vec<DVector<f64>> = (0..candidates.len()).map(whitened).collect();
    let project = |x: &DVector<f64>| x - &now.columns * (&inverse * now.columns.tr_mul(x));
    let free: Vec<DVector<f64>> = raw.iter().map(project).collect();
    let share = |c: usize| free[c].norm_squared() / raw[c].norm_squared().max(1e-300);
    let is_judged = |c: usize| share(c) > rules.least_left && !now.chosen.contains(&c);
    let freedom = (n as f64 - now.step.len() as f64 - 1.0).max(1.0);
    let units = Units::new(&free, is_judged, &now.columns, &inverse, freedom);
    let permuted = MaxT::drawn(options.flips, |k| {
        let mut order: Vec<usize> = (0..n).collect();
        shuffle(&mut stream(options.seed, 0x9E12, k), &mut order);
        let products = units.products(order.iter().map(|i| now.rest[*i]));
        units.largest(&products, now.rest.norm_squared(), |_| true)
    });
    let by_session: Vec<bool> = candidates.iter().map(|c| c.act.by_session).collect();
    let permuted_sessions = by_session
        .contains(&true)
        .then(|| units.by_sessions(&by_session, rows, &now.rest, options));
    let specimens = members(rows.iter().map(|row| row.name.as_str()));
    let sessions = members(rows.iter().map(|row| row.session.as_str()));
    let offsets = [
        (specimens, setting.between.specimens),
        (sessions, setting.between.sessions),
    ];
    let simulated = MaxT::drawn(options.twins.max(MIN_TABLES) as usize, |k| {
        let drawn = simulated_rows(setting, rows, &now, &offsets, [options.seed, k]);
        let rest = fit(setting, &drawn, &now.chosen).rest;
        let products = units.products(rest.iter().copied());
        units.largest(&products, rest.norm_squared(), |_| true)
    });
    let products = units.products(now.rest.iter().copied());
    let score = |(c, free): (usize, DVector<f64>)| {
        let candidate = &candidates[c];
        let t = units.t(products[c], now.rest.norm_squared());
        let p_value = match permuted_sessions.as_ref().filter(|_| by_session[c]) {
            Some(sessions) => sessions.p_value(t),
            None => permuted
                .p_value(t)
                .max(gumbel_tail(&simulated.maxima, t.abs())),
        };
        let size = free.dot(&now.rest) / free.norm_squared().max(1e-300) * candidate.typical;
        Score {
            t,
            size,
            error: 1.0 / free.norm().max(1e-300) * candidate.typical,
            p_value,
            remaining_share: share(c),
            is_admissible: is_judged(c) && candidate.admits(size),
            free,
        }
    };
    TableScreen {
        scores: free.clone().into_iter().enumerate().map(score).collect(),
        detectable_t: simulated.critical(rules.alpha) + options.rules.search.nine_in_ten,
        setting,
        rows,
        fit: now,
    }
}

/// Rows simulated with a fit: errors of mu and of the pressure, and offsets of groups of rows, each
/// with its standard deviation, are drawn; `seed` and number of the draw.
fn simulated_rows(
    setting: &Setting,
    rows: &[Row],
    now: &Fit,
    offsets: &[(BTreeMap<&str, Vec<usize>>, f64)],
    [seed, draw]: [u64; 2],
) -> Vec<Row> {
    let mut rng = stream(seed, 0x7A17, draw);
    let mut drawn = rows.to_vec();
    for (drawn, row) in drawn.iter_mut().zip(rows) {
        drawn.mu = now.predict(setting, row) + row.mu_sd * normal(&mut rng);
        drawn.pressure = row.pressure + row.pressure_sd * normal(&mut rng);
    }
    for (groups, sd) in offsets.iter().filter(|(_, sd)| *sd > 0.0) {
        for own in groups.values() {
            let offset = sd * normal(&mut rng);
            own.iter().for_each(|i| drawn[*i].mu += offset);
        }
    }
    drawn
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
/// Each residual needs only its products with these columns. Standard errors are scaled up if the
/// rows scatter more than stated, never down.
struct Units<'a> {
    /// Candidates, then columns of the base, by row; 0 for a candidate that cannot be judged.
    by_row: DMatrix<f64>,
    candidates: usize,
    inverse: &'a DMatrix<f64>,
    freedom: f64,
}

impl<'a> Units<'a> {
    fn new(
        free: &[DVector<f64>],
        is_judged: impl Fn(usize) -> bool,
        base: &DMatrix<f64>,
        inverse: &'a DMatrix<f64>,
        freedom: f64,
    ) -> Self {
        let candidates = free.len();
        let mut by_row = DMatrix::zeros(candidates + base.ncols(), base.nrows());
        for (c, free) in free.iter().enumerate().filter(|(c, _)| is_judged(*c)) {
            by_row.set_row(c, &(free * (1.0 / free.norm())).transpose());
        }
        by_row
            .rows_mut(candidates, base.ncols())
            .copy_from(&base.transpose());
        Self {
            by_row,
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

    /// t of a score; `squares` is the sum of squares of the projected residual.
    fn t(&self, score: f64, squares: f64) -> f64 {
        let excess = ((squares - score * score) / self.freedom).max(1.0);
        score / excess.sqrt()
    }

    /// The largest |t| of some candidates; `squares` is the sum of squares of the residual.
    fn largest(
        &self,
        products: &DVector<f64>,
        squares: f64,
        wanted: impl Fn(usize) -> bool,
    ) -> f64 {
        let base = products.rows(self.candidates, self.inverse.nrows());
        let squares = squares - base.dot(&(self.inverse * base));
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
    ) -> MaxT {
        let sessions = members(rows.iter().map(|row| row.session.as_str()));
        let sessions: Vec<Vec<usize>> = sessions.into_values().collect();
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
        MaxT::drawn(options.flips, |k| {
            let mut order: Vec<usize> = (0..sessions.len()).collect();
            shuffle(&mut stream(options.seed, 0x9E13, k), &mut order);
            let levels = DVector::from_fn(order.len(), |s, _| means[order[s]]);
            let of_levels = sessions.iter().zip(levels.iter());
            let of_levels = of_levels.map(|(own, level)| own.len() as f64 * level * level);
            let squares = scatter.norm_squared() + of_levels.sum::<f64>();
            self.largest(&(&within + &sums * &levels), squares, |c| by_session[c])
        })
    }
}
