//! Closed share of the explainable misfit, by projection on the explained direction.

use crate::finding::{Interval, undetermined_share};

/// Residuals and directions, in units of their standard deviations.
pub struct ClosedMisfit<'a> {
    /// Direction f: change of the residuals by everything that was fitted to the training rows.
    pub direction: &'a [f64],
    pub before: &'a [f64],
    pub after: &'a [f64],
    /// f on the training rows, to which its length was fitted.
    pub fitted: &'a [f64],
    /// Standard deviation of a residual without missing effects, 1 if the noise is as stated.
    pub spread: f64,
}

impl ClosedMisfit<'_> {
    /// Closed share `1 - |f . r_after| / (f . r_before)` with its 95 % interval. The magnitude
    /// counts a change that is too large like one that is too small.
    ///
    /// The interval includes the noise on these rows and the noise of the fit; it is -1 to 1 if `f
    /// . r_before` does not exceed the noise. f is independent of the noise of rows that were not
    /// fitted, so that r_before needs no correction. The variance of the noise is subtracted from
    /// `(f . r_after)^2` in the value, not in the interval.
    pub fn closed(&self) -> Interval {
        let along = |r: &[f64]| -> f64 { self.direction.iter().zip(r).map(|(f, r)| f * r).sum() };
        let (before, after) = (along(self.before), along(self.after));
        let noise = self.spread * norm(self.direction);
        if before.is_nan() || before <= 0.0 {
            return undetermined_share(0.0);
        }
        let remaining = after.abs() / before;
        let beyond_noise = (after * after - noise * noise).max(0.0).sqrt() / before;
        let value = (1.0 - beyond_noise).max(-1.0);
        if before <= 1.96 * noise {
            return undetermined_share(value);
        }
        let error = 1.96 * (noise / before).hypot(self.spread / norm(self.fitted));
        Interval {
            value,
            low: (1.0 - remaining - error).max(-1.0),
            high: (1.0 - remaining + error).min(1.0).max(value),
        }
    }
}

/// Change of residuals from one model to another.
pub fn change(from: &[f64], to: &[f64]) -> Vec<f64> {
    from.iter().zip(to).map(|(a, b)| a - b).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::normal;
    use crate::null::random::stream;

    /// A fitted size has its own error; the truth is the remaining part of the true change.
    #[test]
    fn intervals_cover_the_share_that_the_fitted_size_closes() {
        let change: Vec<f64> = (0..200).map(|i| 0.5 * (0.2 * i as f64).sin()).collect();
        let (fit, locked) = change.split_at(150);
        let (mut covered, mut full, cases) = (0, 0, 400);
        for k in 0..cases {
            let mut rng = stream(5, k, 0);
            let noisy = |part: &[f64], rng: &mut _| -> Vec<f64> {
                part.iter().map(|c| c + normal(rng)).collect()
            };
            let own = noisy(fit, &mut rng);
            let size = own.iter().zip(fit).map(|(r, c)| r * c).sum::<f64>() / norm(fit).powi(2);
            let before = noisy(locked, &mut rng);
            let by_size = |part: &[f64]| -> Vec<f64> { part.iter().map(|c| size * c).collect() };
            let scaled = by_size(locked);
            let after: Vec<f64> = before.iter().zip(&scaled).map(|(r, s)| r - s).collect();
            let seen = ClosedMisfit {
                direction: &scaled,
                before: &before,
                after: &after,
                fitted: &by_size(fit),
                spread: 1.0,
            };
            let closed = seen.closed();
            let truth = 1.0 - (1.0 - size).abs();
            covered += usize::from(closed.low <= truth && truth <= closed.high);
            full += usize::from(closed.low <= 1.0 && 1.0 <= closed.high);
        }
        assert!(covered * 100 >= 94 * cases as usize, "{covered} of {cases}");
        assert!(full * 100 >= 94 * cases as usize, "{full} of {cases}");
    }

    #[test]
    fn without_an_explainable_misfit_the_interval_is_unbounded() {
        let seen = ClosedMisfit {
            direction: &[0.1, -0.1],
            before: &[0.5, 0.4],
            after: &[0.4, 0.5],
            fitted: &[3.0],
            spread: 1.0,
        };
        let closed = seen.closed();
        assert_eq!((closed.low, closed.high), (-1.0, 1.0));
    }

    #[test]
    fn half_of_a_change_closes_half_and_twice_the_change_nothing() {
        let f = [30.0, -40.0];
        // A change of 50 standard deviations: noise subtracts 2e-4 of a half.
        for (remaining, closed) in [(0.5, 0.5), (-1.0, 0.0), (0.0, 1.0)] {
            let after = f.map(|f| remaining * f);
            let seen = ClosedMisfit {
                direction: &f,
                before: &f,
                after: &after,
                fitted: &[50.0],
                spread: 1.0,
            };
            assert!((seen.closed().value - closed).abs() < 5e-4);
        }
    }
}
