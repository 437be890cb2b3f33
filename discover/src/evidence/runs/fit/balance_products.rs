//! Products of the fitted columns within and between balances, from which any weighting follows.

use nalgebra::{DMatrix, DMatrixView, DVector, Matrix3};
use rayon::prelude::*;

use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::gram::squares;

/// Products of all runs' columns, by balance.
pub struct BalanceProducts {
    /// Blocks of balances, each with its columns and the residual last.
    sum: DMatrix<f64>,
    /// The balance of each block.
    balances: Vec<usize>,
    /// Columns of a block.
    columns: usize,
    pub rows: f64,
}

impl BalanceProducts {
    /// Products of columns in the balances' own units.
    pub fn new(design: &Design, frames: &[Frame]) -> Self {
        let columns = OWN_LEVELS + design.fitted() + 1;
        let balances: Vec<usize> = (0..design.whitener.count())
            .map(|k| design.whitener.channel(k))
            .collect();
        let all = balances.len() * columns;
        let of_run = |frame: &Frame| {
            let (below, n) = (design.columns(frame), frame.row_count());
            let mut by_balance = DMatrix::zeros(n, all);
            for k in 0..balances.len() {
                let block = below.rows(k * n, n);
                by_balance
                    .columns_mut(k * columns, columns)
                    .copy_from(&block);
            }
            squares(&by_balance)
        };
        let each: Vec<DMatrix<f64>> = frames.par_iter().map(of_run).collect();
        let rows: usize = frames.iter().map(Frame::row_count).sum();
        Self {
            sum: each
                .iter()
                .fold(DMatrix::zeros(all, all), |sum, run| sum + run),
            balances,
            columns,
            rows: rows as f64,
        }
    }

    /// Whether every product is finite.
    pub fn are_finite(&self) -> bool {
        self.sum.iter().all(|x| x.is_finite())
    }

    /// Every pair of balances with the products of their columns.
    fn blocks(&self) -> impl Iterator<Item = ((usize, usize), DMatrixView<'_, f64>)> {
        let m = self.columns;
        let places =
            (0..self.balances.len()).flat_map(|a| (0..self.balances.len()).map(move |b| (a, b)));
        places.map(move |(a, b)| {
            let block = self.sum.view((a * m, b * m), (m, m));
            ((self.balances[a], self.balances[b]), block)
        })
    }

    pub fn covariance(&self) -> Matrix3<f64> {
        self.covariance_after(&DVector::zeros(self.columns - 1 - OWN_LEVELS))
    }

    /// Covariance of the residuals after a step, to first order.
    pub fn covariance_after(&self, step: &DVector<f64>) -> Matrix3<f64> {
        let mut along = DVector::zeros(self.columns);
        along[self.columns - 1] = 1.0;
        along.rows_mut(OWN_LEVELS, step.len()).copy_from(&-step);
        let mut remaining = Matrix3::zeros();
        for (at, block) in self.blocks() {
            let square = along.dot(&(block * &along));
            // The linear prediction of a variance is bounded below.
            let least = match at.0 == at.1 {
                true => 1e-9 * block[(self.columns - 1, self.columns - 1)],
                false => f64::NEG_INFINITY,
            };
            remaining[at] = square.max(least) / self.rows.max(1.0);
        }
        remaining
    }

    /// Products of the whitened columns.
    pub fn weighted(&self, whitener: &Whitener) -> DMatrix<f64> {
        let weights = whitener.inverse();
        let none = DMatrix::zeros(self.columns, self.columns);
        self.blocks()
            .fold(none, |sum, (at, block)| sum + block * weights[at])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_and_steps_agree_with_whitened_rows() {
        let (n, m) = (40, OWN_LEVELS + 3);
        let by_balance = DMatrix::from_fn(n, 2 * m, |i, k| {
            ((i * (3 * k + 2)) as f64 * 0.618).sin() + if k % m == m - 1 { 0.3 } else { 0.0 }
        });
        let products = BalanceProducts {
            sum: squares(&by_balance),
            balances: vec![1, 2],
            columns: m,
            rows: n as f64,
        };
        let block = |k: usize| by_balance.columns(k * m, m).into_owned();
        let step = DVector::from_vec(vec![0.4, -0.2]);
        let remaining: Vec<DVector<f64>> = [0, 1]
            .map(|k| block(k).column(m - 1) - block(k).columns(OWN_LEVELS, 2) * &step)
            .into();
        let covariance = products.covariance_after(&step);
        for (a, b) in [(0, 0), (0, 1), (1, 1)] {
            let want = remaining[a].dot(&remaining[b]) / n as f64;
            assert!((covariance[(1 + a, 1 + b)] - want).abs() < 1e-12);
        }
        let whitener = Whitener::of(&products.covariance(), [false, true, true, false]);
        let mut sum = DMatrix::zeros(m, m);
        let rows: Vec<[Vec<f64>; 3]> = (0..m)
            .map(|k| {
                let of = |b: usize| block(b).column(k).as_slice().to_vec();
                let mut rows = [Vec::new(), of(0), of(1)];
                whitener.mix(&mut rows);
                rows
            })
            .collect();
        for a in 0..m {
            for b in 0..m {
                let both = rows[a].concat().into_iter().zip(rows[b].concat());
                sum[(a, b)] = both.map(|(x, y)| x * y).sum::<f64>();
            }
        }
        let weighted = products.weighted(&whitener);
        assert!((weighted - &sum).norm() < 1e-10 * sum.norm());
    }
}
