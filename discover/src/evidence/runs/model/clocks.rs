//! How far the clocks of the channels lie apart.
//!
//! A delay has no meaning of its own, only relative to those of the other channels. Where these lie further apart than is stated, each has a
//! clock of its own, and their deviation is what they show with the one of them that is most significant, which remains free. With G the
//! products of the installation's parts given the base, and H = G + P, P the precisions:
//!
//! ```text
//! sd^2 = sum a_j^2 / sum (1 - [inv H]_jj / sd^2)
//! ```
//!
//! Source: D. J. C. MacKay, Bayesian interpolation, Neural Computation 4 (1992) 415.

use nalgebra::{DMatrix, DVector};

use crate::evidence::runs::model::installation::Installation;
use crate::regression::inverse::ridge_inverse;

/// The squared deviation that the delays show with the one that is most significant, in units of the stated one and not below it, from the
/// parts' products in the rows.
pub fn spread_of_delays(installation: &Installation, products: &DMatrix<f64>) -> f64 {
    let parts = installation.parts.iter().enumerate();
    let late: Vec<usize> = parts
        .filter(|(_, p)| p.is_delay())
        .map(|(j, _)| j)
        .collect();
    let sizes = DVector::from_column_slice(&installation.sizes);
    let scores = products * &sizes + sizes;
    let without = |alone: &usize| spread_beside(*alone, &late, products, &scores);
    late.iter().map(without).reduce(f64::min).unwrap_or(1.0)
}

/// The squared deviation of those of the parts `late` that are not `alone`, nothing being known of that one: at least the stated one.
fn spread_beside(
    alone: usize,
    late: &[usize],
    products: &DMatrix<f64>,
    scores: &DVector<f64>,
) -> f64 {
    const ROUNDS: usize = 100;
    /// A deviation known to a thousandth.
    const ENOUGH: f64 = 2e-3;
    let others = || late.iter().copied().filter(|j| *j != alone);
    let mut spread = 1.0;
    for _ in 0..ROUNDS {
        let mut precision = products.clone();
        for j in (0..scores.len()).filter(|j| !late.contains(j)) {
            precision[(j, j)] += 1.0;
        }
        others().for_each(|j| precision[(j, j)] += 1.0 / spread);
        let open = ridge_inverse(precision);
        let sizes = &open * scores;
        let squares: f64 = others().map(|j| sizes[j].powi(2)).sum();
        let determined: f64 = others().map(|j| 1.0 - open[(j, j)] / spread).sum();
        // Of less than one channel there is no deviation.
        let next = if determined < 1.0 {
            1.0
        } else {
            squares / determined
        };
        let next = next.max(1.0);
        let moved = (next / spread - 1.0).abs();
        spread = next;
        if moved < ENOUGH {
            break;
        }
    }
    spread
}

#[cfg(test)]
mod tests {
    use kufe_sled::Tolerances;

    use super::*;

    #[test]
    fn one_late_channel_leaves_the_clocks_of_the_others_as_stated_and_many_do_not() {
        let delays = Tolerances {
            delay_s: 0.002,
            ..Tolerances::EXACT
        };
        let stated = Installation::new(&delays, []);
        let count = stated.parts.len();
        // Differences alone show, each to a fifth of the stated deviation.
        let common = DMatrix::from_element(count, count, 25.0 / count as f64);
        let products = DMatrix::identity(count, count) * 25.0 - common;
        let precision = DMatrix::identity(count, count) + &products;
        let spread = |late_s: &[f64]| {
            let late = DVector::from_iterator(count, late_s.iter().map(|d| d / 0.002));
            let mut found = stated.clone();
            found.sizes = (ridge_inverse(precision.clone()) * &products * late)
                .iter()
                .copied()
                .collect();
            0.002 * spread_of_delays(&found, &products).sqrt()
        };
        let mut late_s = vec![0.01; count];
        assert!((spread(&late_s) - 0.002).abs() < 1e-9, "one clock");
        late_s[7] += 0.02;
        assert!((spread(&late_s) - 0.002).abs() < 1e-9, "one fault");
        let each: Vec<f64> = (0..count).map(|k| 0.02 * k as f64 / count as f64).collect();
        // Nine of ten even steps of 2 ms, those without one end: 2 sqrt(60 / 8) ms.
        assert!((spread(&each) - 0.00548).abs() < 1e-4, "{}", spread(&each));
    }
}
