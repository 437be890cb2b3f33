//! Significance by randomisation, corrected for looking at many candidates at once.

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::random::{shuffle, sign, stream};
use crate::score::studentised;

/// The null distribution of the largest |T| over all candidates.
#[derive(Clone, Debug)]
pub struct MaxT {
    /// Largest |T| of each randomisation, increasing.
    pub maxima: Vec<f64>,
}

impl MaxT {
    /// Flips the sign of whole runs: under the null a run's scores are as likely positive as negative, whatever the
    /// correlation within it. Westfall and Young's single-step max-T over the rows of `u` (candidates by runs).
    pub fn by_sign_flips(u: &DMatrix<f64>, flips: usize, seed: u64) -> Self {
        let norms: Vec<f64> = (0..u.nrows()).map(|c| u.row(c).norm()).collect();
        Self::with_norms(u, &norms, flips, seed)
    }

    /// The same for sums of scores over given norms, which signs must not change; rows of norm 0 take no part.
    pub fn with_norms(u: &DMatrix<f64>, norms: &[f64], flips: usize, seed: u64) -> Self {
        let (count, runs) = u.shape();
        let mut maxima: Vec<f64> = (0..flips)
            .into_par_iter()
            .map(|k| {
                let mut rng = stream(seed, 0xF11B, k as u64);
                let signs: Vec<f64> = (0..runs).map(|_| sign(&mut rng)).collect();
                let mut sums = vec![0.0; count];
                for (i, s) in signs.iter().enumerate() {
                    for (sum, value) in sums.iter_mut().zip(u.column(i).iter()) {
                        *sum += s * value;
                    }
                }
                sums.iter()
                    .zip(norms)
                    .filter(|(_, norm)| **norm > 0.0)
                    .fold(0.0_f64, |m, (sum, norm)| m.max((sum / norm).abs()))
            })
            .collect();
        maxima.sort_by(f64::total_cmp);
        Self { maxima }
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

/// Upper tail of a Gumbel law fitted by moments to maxima of simulated nulls.
///
/// P(M >= t) = 1 - exp(-exp(-(t - a)/b)), b = sd sqrt(6)/pi, a = mean - 0.5772 b. Maxima over many candidates are close
/// to it, and its tail reaches below 1/(number of twins).
pub fn gumbel_tail(maxima: &[f64], t: f64) -> f64 {
    let n = maxima.len() as f64;
    let mean = maxima.iter().sum::<f64>() / n;
    let sd = (maxima.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let scale = (sd * 6.0_f64.sqrt() / std::f64::consts::PI).max(1e-9);
    let place = mean - 0.577_215_664_9 * scale;
    -(-(-(t - place) / scale).exp()).exp_m1()
}

/// Permutes what belongs to sessions: does `levels` (one a session) follow one of the covariates more than chance?
///
/// Returns, for each covariate, |r| and its max-T p-value; all orders are visited where there are at most 5040.
pub fn by_session_permutation(
    levels: &[f64],
    covariates: &[Vec<f64>],
    permutations: usize,
    seed: u64,
) -> Vec<(f64, f64)> {
    let n = levels.len();
    let centred = |x: &[f64]| -> Vec<f64> {
        let mean = x.iter().sum::<f64>() / n as f64;
        let norm = x.iter().map(|v| (v - mean).powi(2)).sum::<f64>().sqrt();
        x.iter()
            .map(|v| if norm > 0.0 { (v - mean) / norm } else { 0.0 })
            .collect()
    };
    let y = centred(levels);
    let xs: Vec<Vec<f64>> = covariates.iter().map(|x| centred(x)).collect();
    let correlation = |order: &[usize], x: &[f64]| -> f64 {
        order
            .iter()
            .zip(x)
            .map(|(o, x)| y[*o] * x)
            .sum::<f64>()
            .abs()
    };
    let identity: Vec<usize> = (0..n).collect();
    let observed: Vec<f64> = xs.iter().map(|x| correlation(&identity, x)).collect();
    let largest = |order: &[usize]| xs.iter().fold(0.0_f64, |m, x| m.max(correlation(order, x)));
    let maxima: Vec<f64> = if n <= 7 {
        let mut all = Vec::new();
        visit_orders(&mut identity.clone(), 0, &mut |order| {
            all.push(largest(order))
        });
        all
    } else {
        (0..permutations)
            .map(|k| {
                let mut order = identity.clone();
                shuffle(&mut stream(seed, 0x5E55, k as u64), &mut order);
                largest(&order)
            })
            .chain([largest(&identity)])
            .collect()
    };
    observed
        .iter()
        .map(|r| {
            let above = maxima.iter().filter(|m| **m >= r - 1e-12).count();
            (*r, above as f64 / maxima.len() as f64)
        })
        .collect()
}

fn visit_orders(order: &mut [usize], from: usize, visit: &mut impl FnMut(&[usize])) {
    if from + 1 >= order.len() {
        return visit(order);
    }
    for k in from..order.len() {
        order.swap(from, k);
        visit_orders(order, from + 1, visit);
        order.swap(from, k);
    }
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
    use crate::random::normal;

    #[test]
    fn noise_is_claimed_in_the_stated_share_of_data_sets() {
        let mut rng = stream(5, 5, 5);
        let sets = 300;
        let claims = (0..sets)
            .filter(|k| {
                let u = DMatrix::from_fn(40, 20, |_, _| normal(&mut rng));
                let null = MaxT::by_sign_flips(&u, 199, *k);
                let best = statistics(&u).iter().fold(0.0_f64, |m, t| m.max(t.abs()));
                null.p_value(best) <= 0.05
            })
            .count();
        // Binomial with 300 trials at 0.05: mean 15, three deviations 11.
        assert!((4..=26).contains(&claims), "{claims}");
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

    #[test]
    fn sessions_follow_their_covariate_or_not() {
        let covariates = vec![(0..8).map(f64::from).collect::<Vec<_>>()];
        let up: Vec<f64> = (0..8).map(|k| 3.0 * f64::from(k) + 0.1).collect();
        assert!(by_session_permutation(&up, &covariates, 999, 1)[0].1 < 0.01);
        let mixed = [1.0, -1.0, 0.5, -0.7, 0.9, -1.1, 0.6, -0.4];
        assert!(by_session_permutation(&mixed, &covariates, 999, 1)[0].1 > 0.1);
        // Four sessions have 24 orders: no smaller p-value than 2/24 exists.
        let few =
            by_session_permutation(&[1.0, 2.0, 3.0, 4.0], &[vec![1.0, 2.0, 3.0, 4.0]], 999, 1);
        assert!((few[0].1 - 2.0 / 24.0).abs() < 1e-12);
    }
}
