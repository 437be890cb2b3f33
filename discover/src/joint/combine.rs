//! Combination of the sizes of one effect by several kinds of data.
//!
//! ```text
//! size = sum_k size_k / e_k^2  /  sum_k 1 / e_k^2        error = (sum_k 1 / e_k^2)^(-1/2)
//! ```

use crate::procedure::shared_effects::Amount;

/// The inverse-variance weighted mean of the sizes; `None` without any.
pub fn together(amounts: &[Amount]) -> Option<Amount> {
    let weights = amounts.iter().map(|a| a.error.max(1e-300).powi(-2));
    let weights: Vec<f64> = weights.collect();
    let total: f64 = weights.iter().sum();
    let sum: f64 = amounts.iter().zip(&weights).map(|(a, w)| a.value * w).sum();
    let first = amounts.first()?;
    Some(Amount {
        value: sum / total,
        error: total.powf(-0.5),
        ..first.clone()
    })
}

/// Largest ratio of the difference of two sizes to its standard error.
pub fn disagreement(amounts: &[Amount]) -> f64 {
    let pairs = amounts
        .iter()
        .enumerate()
        .flat_map(|(k, a)| amounts[..k].iter().map(move |b| a.t_difference(b)));
    pairs.fold(0.0, f64::max)
}

/// Twice the log-likelihood ratio of one common size to a size of 0: the square of the common t.
pub fn gain(amounts: &[Amount]) -> f64 {
    together(amounts).map_or(0.0, |common| common.t().powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::combined_p_value;

    fn amount(value: f64, error: f64) -> Amount {
        Amount {
            effect: "temperature".to_owned(),
            key: "slope_per_k".to_owned(),
            unit: "1/K".to_owned(),
            value,
            error,
        }
    }

    #[test]
    fn two_sizes_combine_by_inverse_variance() {
        let two = [amount(1.0, 0.1), amount(1.6, 0.2)];
        let common = together(&two).expect("two");
        assert!((common.value - 1.12).abs() < 1e-12);
        assert!((common.error - (0.1_f64.powi(-2) + 0.2_f64.powi(-2)).powf(-0.5)).abs() < 1e-12);
        assert!((disagreement(&two) - 0.6 / 0.05_f64.sqrt()).abs() < 1e-12);
        let expected = two[0].t().powi(2) + two[1].t().powi(2) - disagreement(&two).powi(2);
        assert!((gain(&two) - expected).abs() < 1e-9);
        assert_eq!(together(&[]), None);
    }

    /// The closed form of two: q (1 - ln q), q = p1 p2.
    #[test]
    fn p_values_combine_by_fishers_method() {
        let q: f64 = 0.01 * 0.02;
        assert!((combined_p_value(0.01, 0.02) / (q * (1.0 - q.ln())) - 1.0).abs() < 1e-9);
        assert!((combined_p_value(1.0, 1.0) - 1.0).abs() < 1e-12);
    }
}
