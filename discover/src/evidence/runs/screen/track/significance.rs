//! Significance of a nonlinear candidate, and a line search.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::evidence::runs::screen::track::bins::Bin;

/// Angle between two changes of the bins, up to sign \[rad\].
pub fn angle(a: &[f64], b: &[f64], w: &[f64]) -> f64 {
    let square = (weighted_dot(a, a, w) * weighted_dot(b, b, w)).max(1e-300);
    (weighted_dot(a, b, w).abs() / square.sqrt())
        .min(1.0)
        .acos()
}

/// `sum x y w`.
pub fn weighted_dot(x: &[f64], y: &[f64], w: &[f64]) -> f64 {
    x.iter().zip(y).zip(w).map(|((x, y), w)| x * y * w).sum()
}

/// Two-sided p-value of the maximum |z| over all directions of a candidate that is nonlinear in its
/// size (look-elsewhere effect): the p-value of one direction, plus the bound for an upcrossing of
/// `z` in between, `turn / pi * exp(-z^2 / 2)` (R. B. Davies, Biometrika 74 (1987) 33).
pub fn p_value_of_maximum(z: f64, turn: f64) -> f64 {
    two_sided(z) + turn / std::f64::consts::PI * (-0.5 * z * z).exp()
}

/// Two-sided p-value of a standard normal variate.
pub fn two_sided(z: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(1.0, |law| 2.0 * law.cdf(-z.abs()))
}

/// Inflation of the variance of a mean over bins by autocorrelation, `(1 + rho) / (1 - rho)` with
/// rho the lag-1 correlation of neighbouring bins of a track.
pub fn inflation(bins: &[Bin], values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    let neighbours = bins.windows(2).zip(values.windows(2));
    let products: Vec<f64> = neighbours
        .filter(|(bins, _)| bins[0].track == bins[1].track)
        .map(|(_, pair)| (pair[0] - mean) * (pair[1] - mean))
        .collect();
    let lag = products.iter().sum::<f64>() / products.len().max(1) as f64;
    let rho = (lag / square.max(1e-300)).clamp(0.0, 0.9);
    (1.0 + rho) / (1.0 - rho)
}

/// Minimiser of a function in an interval, to an absolute tolerance, by golden-section search.
pub fn minimise(of: impl Fn(f64) -> f64, [mut from, mut to]: [f64; 2], tolerance: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let inner = |from: f64, to: f64| [to - ratio * (to - from), from + ratio * (to - from)];
    let [mut a, mut b] = inner(from, to);
    let [mut of_a, mut of_b] = [a, b].map(&of);
    while (to - from).abs() > tolerance {
        if of_a < of_b {
            (to, b, of_b) = (b, a, of_a);
            a = inner(from, to)[0];
            of_a = of(a);
        } else {
            (from, a, of_a) = (a, b, of_b);
            b = inner(from, to)[1];
            of_b = of(b);
        }
    }
    0.5 * (from + to)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a turn in a plane meets every direction of it: the maximum is the length of two normal
    /// variates, which exceeds `z` with probability `exp(-z^2 / 2)`.
    #[test]
    fn the_bound_for_all_directions_of_a_plane_is_tight() {
        for z in [2.5, 3.5, 5.0] {
            let exact = f64::exp(-0.5 * z * z);
            let bound = p_value_of_maximum(z, std::f64::consts::PI);
            assert!(
                bound >= exact && bound < 1.3 * exact,
                "{z}: {bound} of {exact}"
            );
            assert_eq!(p_value_of_maximum(z, 0.0), two_sided(z));
        }
    }

    #[test]
    fn directions_turn_by_the_angle_between_them_whatever_their_signs() {
        let w = [1.0, 4.0];
        assert!((angle(&[1.0, 0.0], &[0.0, -0.5], &w) - 0.5 * std::f64::consts::PI).abs() < 1e-12);
        assert!((angle(&[1.0, 0.0], &[-1.0, 0.5], &w) - 0.25 * std::f64::consts::PI).abs() < 1e-12);
        assert!(angle(&[1.0, 2.0], &[-2.0, -4.0], &w) < 1e-7);
    }

    #[test]
    fn the_least_of_a_parabola_is_found_from_either_side() {
        for (from, to) in [(1.0, 4.0), (-4.0, -1.0)] {
            let middle = 0.4 * from + 0.6 * to;
            let found = minimise(|x| (x - middle).powi(2), [from, to], 1e-6);
            assert!((found - middle).abs() < 1e-6, "{found}");
        }
    }
}
