//! Group tests of smooth laws: a penalised spline of each column on each channel, and products of
//! columns.
//!
//! ```text
//! Q = S' (M + w P)^-1 S        z = (Q - mean Q*) / sd Q*        Q*: with flipped signs of whole runs
//! ```
//!
//! P penalises second differences of a spline's coefficients. Source: P. H. C. Eilers, B. D. Marx,
//! Flexible smoothing with B-splines and penalties, Statistical Science 11 (1996) 89.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::evidence::runs::laws::sums::LawSums;
use crate::null::random::{normal, sign, stream};

/// Terms that are tested together.
#[derive(Clone, Debug)]
pub struct Group {
    pub terms: Vec<usize>,
    /// Penalty matrix of their coefficients.
    pub penalty: DMatrix<f64>,
}

impl Group {
    pub fn single(term: usize) -> Self {
        Self {
            terms: vec![term],
            penalty: DMatrix::zeros(1, 1),
        }
    }

    /// Consecutive terms of a spline, with a penalty on second differences.
    pub fn spline(terms: std::ops::Range<usize>, smoothing: f64) -> Self {
        let k = terms.len();
        let mut difference = DMatrix::zeros(k.saturating_sub(2), k);
        for row in 0..k.saturating_sub(2) {
            for (at, weight) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                difference[(row, row + at)] = weight;
            }
        }
        Self {
            terms: terms.collect(),
            penalty: difference.tr_mul(&difference) * smoothing,
        }
    }

    /// The statistic Q, given the inverse matrix.
    fn statistic(&self, inverse: &DMatrix<f64>, sums: &DVector<f64>) -> f64 {
        let own = DVector::from_fn(self.terms.len(), |k, _| sums[self.terms[k]]);
        own.dot(&(inverse * &own))
    }
}

/// Results of sign-flip tests by group.
pub struct GroupTests {
    /// z by group.
    pub z: Vec<f64>,
    /// Largest z of each randomisation, increasing.
    maxima: Vec<f64>,
}

impl GroupTests {
    /// Probability under the null of a largest z at least this big; never 0.
    pub fn p_value(&self, z: f64) -> f64 {
        let above = self.maxima.len() - self.maxima.partition_point(|m| *m < z);
        (above + 1) as f64 / (self.maxima.len() + 1) as f64
    }
}

/// Tests all groups at once; groups without information have z = 0.
pub fn test(sums: &LawSums, groups: &[Group], flips: usize, seed: u64) -> GroupTests {
    let runs = sums.m.len();
    let inverses: Vec<DMatrix<f64>> = groups
        .iter()
        .map(|group| sums.over(&group.terms, 0..runs).inverse(&group.penalty))
        .collect();
    let all = |sums: &DVector<f64>| -> Vec<f64> {
        let each = groups.iter().zip(&inverses);
        each.map(|(group, inverse)| group.statistic(inverse, sums))
            .collect()
    };
    let drawn: Vec<Vec<f64>> = (0..flips)
        .into_par_iter()
        .map(|k| {
            let mut rng = stream(seed, 0x1A35, k as u64);
            let signs = DVector::from_fn(runs, |_, _| sign(&mut rng));
            let mut total = &sums.u * signs;
            for effect in sums.common.column_iter() {
                total += effect * normal(&mut rng);
            }
            all(&total)
        })
        .collect();
    let observed = all(&(sums.u.column_sum() + &sums.shared));
    let n = flips as f64;
    let scale: Vec<(f64, f64)> = (0..groups.len())
        .map(|g| {
            let mean = drawn.iter().map(|q| q[g]).sum::<f64>() / n;
            let square = drawn.iter().map(|q| (q[g] - mean).powi(2)).sum::<f64>() / n;
            (mean, square.sqrt())
        })
        .collect();
    let z = |q: &[f64]| -> Vec<f64> {
        let each = q.iter().zip(&scale);
        each.map(|(q, (mean, sd))| if *sd > 0.0 { (q - mean) / sd } else { 0.0 })
            .collect()
    };
    let mut maxima: Vec<f64> = drawn
        .iter()
        .map(|q| z(q).into_iter().fold(0.0, f64::max))
        .collect();
    maxima.sort_by(f64::total_cmp);
    GroupTests {
        z: z(&observed),
        maxima,
    }
}
