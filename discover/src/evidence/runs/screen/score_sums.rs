//! Sums of scores: what runs give and what the installation, the same in all runs, adds.

use nalgebra::DMatrix;

use crate::regression::scores::Scores;

/// What the sums of scores of several candidates are made of.
#[derive(Clone)]
pub struct ScoreSums {
    /// Candidates by runs.
    pub u: DMatrix<f64>,
    /// What the installation, as it is fitted, adds to each sum.
    pub shared: Vec<f64>,
    /// By how much each installation error may move it: candidates by errors.
    pub common: DMatrix<f64>,
}

impl ScoreSums {
    /// Those of scores.
    pub fn of(scores: &Scores) -> Self {
        Self {
            u: scores.u.clone(),
            shared: scores.shared.clone(),
            common: scores.common.clone(),
        }
    }

    /// Some candidates alone.
    pub fn only(&self, retained: &[usize]) -> Self {
        Self {
            u: self.u.select_rows(retained),
            shared: retained.iter().map(|c| self.shared[*c]).collect(),
            common: self.common.select_rows(retained),
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
