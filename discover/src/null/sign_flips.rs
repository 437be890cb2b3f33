//! Sign-flip tests with a correction for multiple candidates.

use std::ops::Range;

use nalgebra::{DMatrix, DVectorView};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::null::random::{normal, sign, stream};
use crate::regression::scores::studentised;

/// The null distribution of the largest |T| over all candidates.
#[derive(Clone, Debug)]
pub struct MaxT {
    /// Largest |T| of each randomisation, increasing.
    pub maxima: Vec<f64>,
}

impl MaxT {
    /// From the largest |T| of each of `count` randomisations.
    pub(crate) fn drawn(count: usize, largest: impl Fn(u64) -> f64 + Sync + Send) -> Self {
        let draws = (0..count as u64).into_par_iter();
        Self::of(draws.map(largest).collect())
    }

    /// From the largest |T| of each of `count` randomisations, computed in blocks, whose matrix
    /// products cost less.
    pub(crate) fn drawn_in_blocks(
        count: usize,
        largest: impl Fn(Range<u64>) -> Vec<f64> + Sync + Send,
    ) -> Self {
        const BLOCK: usize = 32;
        let starts = (0..count).into_par_iter().step_by(BLOCK);
        let block = |start: usize| largest(start as u64..(start + BLOCK).min(count) as u64);
        Self::of(starts.flat_map_iter(block).collect())
    }

    fn of(mut maxima: Vec<f64>) -> Self {
        maxima.sort_by(f64::total_cmp);
        Self { maxima }
    }

    /// Flips the sign of whole runs: under the null hypothesis the distribution of a run's scores
    /// is symmetric, whatever the correlation within the run. Westfall and Young's single-step
    /// max-T over the rows of `u` (candidates by runs).
    pub fn by_sign_flips(u: &DMatrix<f64>, flips: usize, seed: u64) -> Self {
        let norms: Vec<f64> = (0..u.nrows()).map(|c| u.row(c).norm()).collect();
        Self::with_norms(u, &norms, &DMatrix::zeros(u.nrows(), 0), flips, seed)
    }

    /// Sign-flips of sums of scores divided by given norms, which must not depend on the signs;
    /// rows of norm 0 are excluded.
    ///
    /// Random effects common to all runs are drawn with the signs; `common` (candidates by random
    /// effects) is the derivative of the sums by a standard deviation of each.
    pub fn with_norms(
        u: &DMatrix<f64>,
        norms: &[f64],
        common: &DMatrix<f64>,
        flips: usize,
        seed: u64,
    ) -> Self {
        Self::drawn_in_blocks(flips, |draws| {
            let streams = draws.map(|k| stream(seed, 0xF11B, k));
            let [signs, sizes] = drawn(streams, [u.ncols(), common.ncols()], sign);
            let sums = u * signs + common * sizes;
            let largest = |sums: DVectorView<f64>| {
                let judged = sums.iter().zip(norms).filter(|(_, norm)| **norm > 0.0);
                judged.fold(0.0_f64, |m, (sum, norm)| m.max((sum / norm).abs()))
            };
            sums.column_iter().map(largest).collect()
        })
    }

    /// Probability under the null of a largest |T| at least this big; never 0.
    pub fn p_value(&self, t: f64) -> f64 {
        let above = self.maxima.len() - self.maxima.partition_point(|m| *m < t.abs() - 1e-12);
        (above + 1) as f64 / (self.maxima.len() + 1) as f64
    }

    /// The |T| that a share `alpha` of randomisations exceeds.
    pub fn critical(&self, alpha: f64) -> f64 {
        let at = ((1.0 - alpha) * self.maxima.len() as f64).floor() as usize;
        self.maxima[at.min(self.maxima.len() - 1)]
    }
}

/// Weights of units and standard normal sizes of random effects, a column of each per stream.
pub(crate) fn drawn(
    streams: impl Iterator<Item = ChaCha8Rng>,
    [units, effects]: [usize; 2],
    weight: impl Fn(&mut ChaCha8Rng) -> f64,
) -> [DMatrix<f64>; 2] {
    let (mut weights, mut sizes) = (Vec::new(), Vec::new());
    let mut count = 0;
    for mut rng in streams {
        weights.extend((0..units).map(|_| weight(&mut rng)));
        sizes.extend((0..effects).map(|_| normal(&mut rng)));
        count += 1;
    }
    [
        DMatrix::from_vec(units, count, weights),
        DMatrix::from_vec(effects, count, sizes),
    ]
}

/// |T| of each row.
pub fn statistics(u: &DMatrix<f64>) -> Vec<f64> {
    (0..u.nrows())
        .map(|c| studentised(u.row(c).iter().copied()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_significant_at_the_stated_rate() {
        let mut rng = stream(5, 5, 5);
        let sets = 300;
        let detections = (0..sets)
            .filter(|k| {
                let u = DMatrix::from_fn(40, 20, |_, _| normal(&mut rng));
                let null = MaxT::by_sign_flips(&u, 199, *k);
                let best = statistics(&u).iter().fold(0.0_f64, |m, t| m.max(t.abs()));
                null.p_value(best) <= 0.05
            })
            .count();
        // Binomial with 300 trials at 0.05: mean 15, three deviations 11.
        assert!((4..=26).contains(&detections), "{detections}");
    }

    #[test]
    fn a_steady_score_is_found_among_noise() {
        let mut rng = stream(6, 6, 6);
        let u = DMatrix::from_fn(40, 20, |c, _| {
            normal(&mut rng) + if c == 7 { 2.0 } else { 0.0 }
        });
        let null = MaxT::by_sign_flips(&u, 999, 1);
        let t = statistics(&u);
        assert!(null.p_value(t[7]) <= 0.005);
    }
}
