//! Scores of each candidate, run by run, after a refit of the base.
//!
//! With J the columns of the base, c the column of a candidate and r the residual (all whitened,
//! with each run's levels projected out), and products summed over runs i:
//!
//! ```text
//! c' = c - J (J'J)^-1 J'c        r' = r - J (J'J)^-1 J'r        U_i = c'_i . r'_i        I_i = c'_i . c'_i
//! ```
//!
//! (sum U) / (sum I) estimates the candidate's size, (sum U)^2 / (sum I) is its gain, and T = (sum
//! U) / sqrt(sum U^2) the test statistic.
//!
//! If J contains random effects with a prior precision P, c' = c - J B with B = (J'J + P)^-1 J'c.
//! The sums are then those of generalised least squares: B'P a, with a the fitted random effects,
//! is added to sum U, and B'P B to sum I. The latter is also the variance of sum U due to the
//! random effects, which are common to all runs.

use nalgebra::{DMatrix, DVector};

use crate::regression::gram::{Gram, acting};
use crate::regression::prior::Prior;

/// Scores of all candidates by unit (run or session), the windows after the regular ones.
#[derive(Clone, Debug)]
pub struct Scores {
    /// U by candidate and unit.
    pub u: DMatrix<f64>,
    /// I by candidate and unit.
    pub information: DMatrix<f64>,
    /// c.c by candidate, before the base is projected out.
    pub raw: Vec<f64>,
    /// Contribution of the fitted random effects to a candidate's sum over units.
    pub shared: Vec<f64>,
    /// Derivative of a candidate's sum by each random effect, per standard deviation.
    pub common: DMatrix<f64>,
}

impl Scores {
    /// Scores with as many leading base columns as the prior has parameters.
    pub fn new(grams: &[Gram], prior: &Prior) -> Self {
        let base = prior.count();
        let m = grams[0].g.ncols();
        let regular = m - base - 1;
        let count = regular + grams[0].windows.nrows();
        // Products of the base with itself and the residual, and with the candidates.
        let mut total = DMatrix::zeros(base, m);
        let mut crossed = DMatrix::zeros(base, count);
        let all: Vec<usize> = (0..base).collect();
        for gram in grams {
            total += gram.g.rows(0, base);
            crossed += gram.with_candidates(&all, base);
        }
        let inverse = prior.inverse(total.columns(0, base).into_owned());
        let by_residual: DVector<f64> = &inverse * (total.column(m - 1) + prior.scores(&prior.at));
        let betas = &inverse * crossed;
        let random: Vec<usize> = (0..base).filter(|k| prior.precision[*k] > 0.0).collect();
        let common = DMatrix::from_fn(count, random.len(), |c, k| {
            prior.precision[random[k]].sqrt() * betas[(random[k], c)]
        });
        let weighted = -prior.scores(&(&prior.at + &by_residual));
        let shared = (0..count).map(|c| betas.column(c).dot(&weighted)).collect();
        let mut u = DMatrix::zeros(count, grams.len());
        let mut information = u.clone();
        let mut raw = vec![0.0; count];
        for (i, gram) in grams.iter().enumerate() {
            let acting = acting(&gram.g, base);
            let rows = gram.g.select_rows(&acting);
            let jj = rows.select_columns(&acting);
            let betas = betas.select_rows(&acting);
            let by_residual = by_residual.select_rows(&acting);
            // J'r of this run with the base refitted.
            let jr = rows.column(m - 1) - &jj * &by_residual;
            let jc = gram.with_candidates(&acting, base);
            let jb = jj * &betas;
            for c in 0..count {
                let (cr, cc) = match c.checked_sub(regular) {
                    None => (gram.g[(base + c, m - 1)], gram.g[(base + c, base + c)]),
                    Some(w) => (gram.windows[(w, m - 1)], gram.window_norms[w]),
                };
                let (beta, jc) = (betas.column(c), jc.column(c));
                u[(c, i)] = cr - jc.dot(&by_residual) - beta.dot(&jr);
                information[(c, i)] = cc - 2.0 * beta.dot(&jc) + beta.dot(&jb.column(c));
                raw[c] += cc;
            }
        }
        Self {
            u,
            information,
            raw,
            shared,
            common,
        }
    }

    /// Total information of a candidate.
    pub fn total_information(&self, candidate: usize) -> f64 {
        (self.information.row(candidate).sum() + self.shared_variance(candidate)).max(0.0)
    }

    /// Sum of a candidate's scores.
    pub fn sum(&self, candidate: usize) -> f64 {
        self.u.row(candidate).sum() + self.shared[candidate]
    }

    /// Variance of the sum of a candidate's scores due to random effects, common to all runs.
    pub fn shared_variance(&self, candidate: usize) -> f64 {
        self.common.row(candidate).norm_squared()
    }

    /// Share of a candidate's information that remains after a refit of the base.
    pub fn remaining_share(&self, candidate: usize) -> f64 {
        if self.raw[candidate] > 0.0 {
            self.total_information(candidate) / self.raw[candidate]
        } else {
            0.0
        }
    }
}

/// T = sum U / sqrt(sum U^2) of one candidate.
pub fn studentised(u: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut square) = (0.0, 0.0);
    for value in u {
        sum += value;
        square += value * value;
    }
    if square > 0.0 {
        sum / square.sqrt()
    } else {
        0.0
    }
}

/// Products of two candidates after projection on the complement of the base, summed over runs;
/// regular candidates only.
pub fn cross_information(grams: &[Gram], prior: &Prior) -> DMatrix<f64> {
    let base = prior.count();
    let m = grams[0].g.ncols();
    let mut total = DMatrix::zeros(m, m);
    for gram in grams {
        total += &gram.g;
    }
    let q = m - base - 1;
    let inverse = prior.inverse(total.view((0, 0), (base, base)).into_owned());
    let jc = total.view((0, base), (base, q)).into_owned();
    total.view((base, base), (q, q)) - jc.tr_mul(&(inverse * &jc))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::normal;
    use crate::null::random::stream;

    #[test]
    fn scores_equal_those_of_explicit_projection() {
        let mut rng = stream(1, 2, 3);
        let (levels, base, q, runs) = (1, 2, 3, 4);
        let m = levels + base + q + 1;
        let all: Vec<DMatrix<f64>> = (0..runs)
            .map(|_| DMatrix::from_fn(30, m, |_, _| normal(&mut rng)))
            .collect();
        let grams: Vec<Gram> = all
            .iter()
            .map(|x| {
                // A window that equals the first candidate must have its scores.
                let w = DMatrix::from_fn(1, m, |_, k| x.column(levels + base).dot(&x.column(k)));
                let norm = x.column(levels + base).norm_squared();
                Gram::new(&x.tr_mul(x), levels, &w, &[norm])
            })
            .collect();
        let scores = Scores::new(&grams, &Prior::none(base));
        // Explicitly: take each run's level out, stack, project on the base.
        let free: Vec<DMatrix<f64>> = all
            .iter()
            .map(|x| {
                let n = x.column(0).normalize();
                let rest = x.columns(1, m - 1).into_owned();
                &rest - &n * (n.transpose() * &rest)
            })
            .collect();
        let stacked = DMatrix::from_fn(30 * runs, m - 1, |i, j| free[i / 30][(i % 30, j)]);
        let j = stacked.columns(0, base).into_owned();
        let hat = &j * (j.tr_mul(&j)).try_inverse().unwrap() * j.transpose();
        let r = stacked.column(m - 2) - &hat * stacked.column(m - 2);
        for c in 0..q {
            let column = stacked.column(base + c);
            let projected = column - &hat * column;
            for i in 0..runs {
                let u: f64 = (0..30).map(|k| projected[30 * i + k] * r[30 * i + k]).sum();
                let info: f64 = (0..30).map(|k| projected[30 * i + k].powi(2)).sum();
                assert!((u - scores.u[(c, i)]).abs() < 1e-9);
                assert!((info - scores.information[(c, i)]).abs() < 1e-9);
            }
        }
        for i in 0..runs {
            assert!((scores.u[(q, i)] - scores.u[(0, i)]).abs() < 1e-9);
            assert!((scores.information[(q, i)] - scores.information[(0, i)]).abs() < 1e-9);
        }
    }

    /// Compared with the explicit covariance, V = 1 + N N' over the rows of all runs.
    #[test]
    fn with_random_effects_sums_are_those_of_generalised_least_squares() {
        let mut rng = stream(4, 5, 6);
        let (rows, runs, base, q) = (20, 3, 2, 2);
        let m = base + q + 1;
        let all: Vec<DMatrix<f64>> = (0..runs)
            .map(|_| DMatrix::from_fn(rows, 1 + m, |_, _| normal(&mut rng)))
            .collect();
        let grams: Vec<Gram> = all
            .iter()
            .map(|x| Gram::new(&x.tr_mul(x), 1, &DMatrix::zeros(0, 1 + m), &[]))
            .collect();
        let mut prior = Prior::none(base);
        (prior.precision[1], prior.at[1]) = (1.0, 0.4);
        let scores = Scores::new(&grams, &prior);
        let free: Vec<DMatrix<f64>> = all
            .iter()
            .map(|x| {
                let n = x.column(0).normalize();
                let rest = x.columns(1, m).into_owned();
                &rest - &n * (n.transpose() * &rest)
            })
            .collect();
        let x = DMatrix::from_fn(rows * runs, m, |i, j| free[i / rows][(i % rows, j)]);
        let n = x.column(1);
        // The residual is that of a model in which the random effect is already 0.4.
        let y = x.column(m - 1) + n * 0.4;
        let v = DMatrix::identity(rows * runs, rows * runs) + n * n.transpose();
        let inverse = v.try_inverse().unwrap();
        let j = x.column(0);
        let weighted = &inverse * j;
        let along =
            |a: &DVector<f64>| &inverse * a - &weighted * (weighted.dot(a) / weighted.dot(&j));
        for c in 0..q {
            let column = x.column(base + c).into_owned();
            let (u, information) = (along(&y).dot(&column), along(&column).dot(&column));
            assert!((scores.sum(c) - u).abs() < 1e-9);
            assert!((scores.total_information(c) - information).abs() < 1e-9);
        }
        let cross = cross_information(&grams, &prior);
        let (a, b) = (x.column(base).into_owned(), x.column(base + 1));
        assert!((cross[(0, 1)] - along(&a).dot(&b)).abs() < 1e-9);
    }
}
