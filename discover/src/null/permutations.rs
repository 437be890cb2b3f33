//! Permutation tests of session-level quantities.

use crate::null::random::{shuffle, stream};
use crate::null::sign_flips::MaxT;

/// Tests `levels` (one per session) against covariates by permutation of the sessions.
///
/// Returns, for each covariate, |r| and its max-T p-value; all orders are visited if there are at
/// most 5040.
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
        let pairs = order.iter().zip(x);
        pairs.map(|(o, x)| y[*o] * x).sum::<f64>().abs()
    };
    let identity: Vec<usize> = (0..n).collect();
    let largest = |order: &[usize]| xs.iter().fold(0.0_f64, |m, x| m.max(correlation(order, x)));
    let null = if n <= 7 {
        let mut maxima = Vec::new();
        visit_orders(&mut identity.clone(), 0, &mut |order| {
            maxima.extend((order != identity).then(|| largest(order)))
        });
        maxima.sort_by(f64::total_cmp);
        MaxT { maxima }
    } else {
        MaxT::drawn(permutations, |k| {
            let mut order = identity.clone();
            shuffle(&mut stream(seed, 0x5E55, k), &mut order);
            largest(&order)
        })
    };
    let observed = xs.iter().map(|x| correlation(&identity, x));
    observed.map(|r| (r, null.p_value(r))).collect()
}

/// Calls `visit` with every permutation of the elements from `from` on.
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

#[cfg(test)]
mod tests {
    use super::*;

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
