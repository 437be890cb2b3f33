//! Sums of scores: contributions of runs, and of the installation, common to all runs.

use nalgebra::DMatrix;

use crate::regression::scores::Scores;

/// Sums of scores of several candidates.
#[derive(Clone)]
pub struct ScoreSums {
    pub u: DMatrix<f64>,
    /// Contribution of the fitted installation errors to each sum.
    pub shared: Vec<f64>,
    /// Derivative of each sum by each installation error: candidates by errors.
    pub common: DMatrix<f64>,
}

impl ScoreSums {
    pub fn of(scores: &Scores) -> Self {
        Self {
            u: scores.u.clone(),
            shared: scores.shared.clone(),
            common: scores.common.clone(),
        }
    }

    /// Some of the candidates.
    pub fn only(&self, selected: &[usize]) -> Self {
        Self {
            u: self.u.select_rows(selected),
            shared: selected.iter().map(|c| self.shared[*c]).collect(),
            common: self.common.select_rows(selected),
        }
    }

    /// Adds a candidate of other scores.
    pub fn push(&mut self, from: &Self, candidate: usize) {
        let rows = self.u.nrows();
        let grown = |to: &DMatrix<f64>, from: &DMatrix<f64>| {
            let mut grown = to.clone().insert_row(rows, 0.0);
            grown.row_mut(rows).copy_from(&from.row(candidate));
            grown
        };
        self.u = grown(&self.u, &from.u);
        self.common = grown(&self.common, &from.common);
        self.shared.push(from.shared[candidate]);
    }

    /// T of candidate `a` less `share` of candidate `b`.
    pub fn t_less(&self, a: usize, b: usize, share: f64) -> f64 {
        let difference = self.u.row(a) - self.u.row(b) * share;
        let common = self.common.row(a) - self.common.row(b) * share;
        let sum = difference.sum() + self.shared[a] - share * self.shared[b];
        let norm = (difference.norm_squared() + common.norm_squared()).sqrt();
        if norm > 0.0 { sum / norm } else { 0.0 }
    }
}
