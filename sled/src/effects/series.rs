//! Delays in time and in distance: a series shifted in time, and forces that lag behind the slip.

/// A series shifted by `samples`, not necessarily a whole number:
/// `result[i] = series[i + samples]`. Constant outside the ends.
///
/// Interpolates by the polynomial of degree 5 through the six nearest samples. The error of a sine
/// with a period of twelve samples is 1e-4 of its amplitude, of six samples 5e-3.
///
/// ```
/// let ramp: Vec<f64> = (0..20).map(f64::from).collect();
/// let later = kufe_sled::effects::ahead(&ramp, 2.25);
/// assert!((later[10] - 12.25).abs() < 1e-12);
/// ```
pub fn ahead(series: &[f64], samples: f64) -> Vec<f64> {
    const FIRST: isize = -2;
    let last = series.len() as isize - 1;
    // A larger shift has the same result, and could overflow.
    let samples = samples.clamp(-(series.len() as f64), series.len() as f64);
    let whole = samples.floor();
    let part = samples - whole;
    let nodes: [f64; 6] = std::array::from_fn(|j| j as f64 + FIRST as f64);
    let weight = |j: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
        others
            .map(|(_, node)| (part - node) / (nodes[j] - node))
            .product()
    };
    let weights: [f64; 6] = std::array::from_fn(weight);
    let first = whole as isize + FIRST;
    let value = |i: isize| -> f64 {
        let near = weights.iter().zip(i + first..);
        near.map(|(w, k)| w * series[k.clamp(0, last) as usize])
            .sum()
    };
    // Samples whose six neighbours are all within the series.
    let len = series.len() as isize;
    let from = (-first).clamp(0, len);
    let to = (len - first - nodes.len() as isize + 1).clamp(from, len);
    let within = |near: &[f64]| -> f64 { weights.iter().zip(near).map(|(w, x)| w * x).sum() };
    let windows = series.windows(nodes.len());
    let inner = windows.skip((from + first).max(0) as usize).map(within);
    (0..from)
        .map(value)
        .chain(inner.take((to - from) as usize))
        .chain((to..len).map(value))
        .collect()
}

/// Slip angles with a relaxation length sigma, front and rear, sample by sample:
///
/// ```text
/// (sigma/v) da'/dt + a' = a
/// ```
///
/// The solution is exact for a slip that is the cubic Hermite interpolant of its values and rates
/// between samples.
///
/// Source: H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 7.
#[derive(Clone, Copy, Debug, Default)]
pub struct Relaxed {
    last: Option<[RelaxedSlip; 2]>,
}

/// Slip at a sample [rad], its rate [rad/s], and the lag of the relaxed slip [rad].
#[derive(Clone, Copy, Debug)]
struct RelaxedSlip {
    slip: f64,
    rate: f64,
    lag: f64,
}

impl Relaxed {
    /// Rates of the relaxed slips [rad/s] at the next sample, `dt_s` after the previous one, from
    /// the slips [rad], their rates [rad/s], the speed `v` \[m/s\] and the relaxation length
    /// `distance` \[m\], which is positive. At the first sample the rate is that of the slip.
    pub fn rates(
        &mut self,
        slip: [f64; 2],
        rate: [f64; 2],
        v: f64,
        dt_s: f64,
        distance: f64,
    ) -> [f64; 2] {
        let per_s = v / distance;
        let lag = |k: usize| {
            let Some(last) = &self.last else {
                return rate[k] / per_s;
            };
            let then = &last[k];
            let mean_rate = (slip[k] - then.slip) / dt_s;
            let slopes = [then.rate, mean_rate, rate[k]];
            then.lag * (-per_s * dt_s).exp() + dt_s * lag_integral(slopes, per_s * dt_s)
        };
        let now = [0, 1].map(|k| RelaxedSlip {
            slip: slip[k],
            rate: rate[k],
            lag: lag(k),
        });
        self.last = Some(now);
        now.map(|now| per_s * now.lag)
    }
}

/// Integral of the cubic's slope times `e^(-x (1 - u))` over u from 0 to 1, from the slope at the
/// start, its mean and the slope at the end.
fn lag_integral([start, mean, end]: [f64; 3], x: f64) -> f64 {
    // Below this value the recursion loses digits.
    const SMALL: f64 = 0.02;
    let [one, u, squared] = if x < SMALL {
        [
            1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x / 24.0)),
            1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)),
            1.0 / 3.0 - x * (1.0 / 12.0 - x * (1.0 / 60.0 - x / 360.0)),
        ]
    } else {
        let one = -(-x).exp_m1() / x;
        let u = (1.0 - one) / x;
        [one, u, (1.0 - 2.0 * u) / x]
    };
    start * one
        + (6.0 * mean - 4.0 * start - 2.0 * end) * u
        + (3.0 * (start + end) - 6.0 * mean) * squared
}

#[cfg(test)]
mod series_tests {
    use super::*;

    #[test]
    fn a_wave_read_ahead_is_the_wave_a_moment_later() {
        // The remainder of a polynomial of fifth order: the product of six distances, at most
        // 15/64 * 15 h^6 / 6!, times w^6.
        for (radians, error) in [(0.25, 3e-6), (std::f64::consts::TAU / 12.0, 2e-4)] {
            let wave = |t: f64| (radians * t).sin();
            let x: Vec<f64> = (0..200).map(|k| wave(f64::from(k))).collect();
            for by in [-20.5, -2.3, -0.4, 0.0, 0.7, 3.0, 11.6] {
                let moved = ahead(&x, by);
                for (k, moved) in moved.iter().enumerate().take(170).skip(30) {
                    let off = (moved - wave(k as f64 + by)).abs();
                    assert!(off < error, "{radians} by {by}: {off}");
                }
            }
        }
    }

    #[test]
    fn beyond_its_ends_a_series_stays_as_it_is_there() {
        let x: Vec<f64> = (0..10).map(f64::from).collect();
        assert!(ahead(&x, 1e300).iter().all(|x| *x == 9.0));
        assert!(ahead(&x, -50.0).iter().all(|x| *x == 0.0));
        assert!(ahead(&[], 3.0).is_empty());
    }
}

#[cfg(test)]
mod relaxed_tests {
    use super::*;

    /// a' = sin(omega t - phi) / sqrt(1 + (omega tau)^2) with tan(phi) = omega tau.
    #[test]
    fn a_wave_is_followed_as_by_a_first_order_lag() {
        let (v, omega) = (24.0, 18.0);
        for distance in [1e-3_f64, 0.05, 0.4, 8.0] {
            for dt in [1e-4, 0.01, 0.016] {
                let mut relaxed = Relaxed::default();
                let slow: f64 = omega * distance / v;
                let settled = 30.0 * distance / v;
                for i in 0..(2.0 * settled / dt) as usize + 100 {
                    let t = i as f64 * dt;
                    let (slip, rate) = ((omega * t).sin(), omega * (omega * t).cos());
                    let rates = relaxed.rates([slip, 0.0], [rate, 0.0], v, dt, distance);
                    let want = omega * (omega * t - slow.atan()).cos() / slow.hypot(1.0);
                    let off = (rates[0] - want).abs() / omega;
                    assert!(t < settled || off < 3e-4, "{off} at {distance} m, {dt} s");
                }
            }
        }
    }
}
