//! Scores and information of groups of columns after a refit of the base, by run.
//!
//! As [`Scores`](crate::regression::Scores), with all products of the columns with each other. With
//! B = (J'J + P)^-1 J'C, c' = C - J B, r' the residual after a refit and a the random effects,
//!
//! ```text
//! u_i = c'_i' r'_i   M_i = c'_i' c'_i      S = sum u_i + B'P a     M = sum M_i + B'P B
//! ```

use nalgebra::{DMatrix, DVector};

use crate::regression::gram::{Gram, acting};
use crate::regression::inverse::ridge_inverse;
use crate::regression::prior::Prior;

/// Folds of cross-validation over runs.
const FOLDS: usize = 5;

/// Sums of all columns.
#[derive(Clone)]
pub struct LawSums {
    /// u by column and run.
    pub u: DMatrix<f64>,
    /// M of each run.
    pub m: Vec<DMatrix<f64>>,
    /// Contribution of random effects to S.
    pub shared: DVector<f64>,
    /// Derivative of S by each random effect, per standard deviation: columns by random effects.
    pub common: DMatrix<f64>,
}

impl LawSums {
    /// From each run's products: levels, base, columns, residual.
    pub fn new(products: &[DMatrix<f64>], levels: usize, prior: &Prior) -> Self {
        let none = DMatrix::zeros(0, products[0].ncols());
        let grams: Vec<DMatrix<f64>> = products
            .iter()
            .map(|full| Gram::new(full, levels, &none, &[]).g)
            .collect();
        let (p, n) = (prior.count(), grams[0].ncols());
        let q = n - 1 - p;
        let mut total = DMatrix::zeros(n, n);
        for gram in &grams {
            total += gram;
        }
        let inverse = prior.inverse(total.view((0, 0), (p, p)).into_owned());
        let of_residual: DVector<f64> =
            &inverse * (total.view((0, n - 1), (p, 1)).column(0) + prior.scores(&prior.at));
        let b = &inverse * total.view((0, p), (p, q));
        let random: Vec<usize> = (0..p).filter(|k| prior.precision[*k] > 0.0).collect();
        let mut u = DMatrix::zeros(q, grams.len());
        let mut m = Vec::with_capacity(grams.len());
        for (i, gram) in grams.iter().enumerate() {
            let acting = acting(gram, p);
            let rows = gram.select_rows(&acting);
            let jj = rows.select_columns(&acting);
            let jc = rows.columns(p, q);
            let (b, of_residual) = (b.select_rows(&acting), of_residual.select_rows(&acting));
            let residual_scores = rows.column(n - 1) - &jj * &of_residual;
            let scores = gram.view((p, n - 1), (q, 1)).column(0)
                - jc.tr_mul(&of_residual)
                - b.tr_mul(&residual_scores);
            u.set_column(i, &scores);
            let half = jc.tr_mul(&b);
            let information =
                gram.view((p, p), (q, q)) - &half - half.transpose() + b.tr_mul(&(&jj * &b));
            m.push(information);
        }
        let fitted = &prior.at + &of_residual;
        Self {
            u,
            m,
            shared: -b.tr_mul(&prior.scores(&fitted)),
            common: DMatrix::from_fn(q, random.len(), |c, k| {
                prior.precision[random[k]].sqrt() * b[(random[k], c)]
            }),
        }
    }

    /// Keeps the first `count` columns.
    pub fn truncate(&mut self, count: usize) {
        self.u = self.u.rows(0, count).into_owned();
        self.shared = self.shared.rows(0, count).into_owned();
        self.common = self.common.rows(0, count).into_owned();
        for m in &mut self.m {
            *m = m.view((0, 0), (count, count)).into_owned();
        }
    }

    /// Concatenates sums of the same runs; products between them count as 0.
    pub fn concatenated(parts: &[LawSums]) -> LawSums {
        let count = parts.iter().map(|part| part.u.nrows()).sum();
        let (runs, random) = parts
            .first()
            .map_or((0, 0), |part| (part.m.len(), part.common.ncols()));
        let mut all = LawSums {
            u: DMatrix::zeros(count, runs),
            m: vec![DMatrix::zeros(count, count); runs],
            shared: DVector::zeros(count),
            common: DMatrix::zeros(count, random),
        };
        let mut at = 0;
        for part in parts {
            let n = part.u.nrows();
            all.u.rows_mut(at, n).copy_from(&part.u);
            all.shared.rows_mut(at, n).copy_from(&part.shared);
            all.common.rows_mut(at, n).copy_from(&part.common);
            for (all, m) in all.m.iter_mut().zip(&part.m) {
                all.view_mut((at, at), (n, n)).copy_from(m);
            }
            at += n;
        }
        all
    }

    /// S and M of some columns over these runs, with a share of the random effects' contribution in
    /// proportion to the number of runs.
    pub fn over(&self, columns: &[usize], runs: impl Iterator<Item = usize>) -> NormalEquations {
        let k = columns.len();
        let mut part = NormalEquations {
            s: DVector::zeros(k),
            m: DMatrix::zeros(k, k),
        };
        let share = 1.0 / self.m.len() as f64;
        for i in runs {
            for (a, c) in columns.iter().enumerate() {
                part.s[a] += self.u[(*c, i)] + share * self.shared[*c];
                for (b, d) in columns.iter().enumerate() {
                    let common = self.common.row(*c).dot(&self.common.row(*d));
                    part.m[(a, b)] += self.m[i][(*c, *d)] + share * common;
                }
            }
        }
        part
    }

    /// Cross-validated gain by run, in units of the noise's variance.
    pub fn cross_validated_gains(&self, columns: &[usize], penalty: &DMatrix<f64>) -> Vec<f64> {
        let runs = self.m.len();
        let folds = FOLDS.min(runs).max(2);
        let mut gains = vec![0.0; runs];
        for fold in 0..folds {
            let size = self
                .over(columns, (0..runs).filter(|i| i % folds != fold))
                .size(penalty);
            for i in (fold..runs).step_by(folds) {
                let left_out = self.over(columns, std::iter::once(i));
                gains[i] = 2.0 * size.dot(&left_out.s) - size.dot(&(&left_out.m * &size));
            }
        }
        gains
    }
}

/// Normal equations of some columns: scores S and information M.
pub struct NormalEquations {
    pub s: DVector<f64>,
    pub m: DMatrix<f64>,
}

impl NormalEquations {
    /// Penalised least-squares sizes; the penalty is in units of the mean diagonal of M.
    pub fn size(&self, penalty: &DMatrix<f64>) -> DVector<f64> {
        self.inverse(penalty) * &self.s
    }

    /// `(M + w P)^-1`, w being the mean diagonal of M.
    pub fn inverse(&self, penalty: &DMatrix<f64>) -> DMatrix<f64> {
        let weight = (self.m.trace() / self.m.nrows() as f64).max(0.0);
        ridge_inverse(&self.m + penalty * weight)
    }
}

/// Sum of the gains of all runs.
pub fn total(gains: &[f64]) -> f64 {
    gains.iter().sum()
}

/// Difference of two gains, with its standard error over runs.
pub fn difference(first: &[f64], second: &[f64]) -> [f64; 2] {
    let each: Vec<f64> = first.iter().zip(second).map(|(a, b)| a - b).collect();
    let n = each.len() as f64;
    let sum: f64 = each.iter().sum();
    let squares: f64 = each.iter().map(|d| (d - sum / n).powi(2)).sum();
    [sum, (squares * n / (n - 1.0).max(1.0)).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::{normal, stream};
    use crate::regression::scores::Scores;

    #[test]
    fn single_columns_have_the_scores_of_the_screen() {
        let mut rng = stream(3, 1, 4);
        let (levels, base, q) = (2, 3, 4);
        let n = levels + base + q + 1;
        let products: Vec<DMatrix<f64>> = (0..5)
            .map(|_| {
                let x = DMatrix::from_fn(40, n, |_, _| normal(&mut rng));
                x.tr_mul(&x)
            })
            .collect();
        let mut prior = Prior::none(base);
        (prior.precision[2], prior.at[2]) = (1.0, 0.7);
        let none = DMatrix::zeros(0, n);
        let grams: Vec<Gram> = products
            .iter()
            .map(|x| Gram::new(x, levels, &none, &[]))
            .collect();
        let known = Scores::new(&grams, &prior);
        let sums = LawSums::new(&products, levels, &prior);
        for c in 0..q {
            let part = sums.over(&[c], 0..5);
            assert!((part.s[0] - known.sum(c)).abs() < 1e-9);
            assert!((part.m[(0, 0)] - known.total_information(c)).abs() < 1e-9);
        }
    }
}
