//! Forces that follow the slip after a distance.

/// Slip angles as forces follow them, front and rear, sample after sample:
///
/// ```text
/// (sigma/v) da'/dt + a' = a
/// ```
///
/// Between samples the slip goes as the cubic through its values and rates, for which the solution is exact.
///
/// Source: H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 7.
#[derive(Clone, Copy, Debug, Default)]
pub struct Relaxed {
    last: Option<[Followed; 2]>,
}

/// A slip at a sample [rad], its rate [rad/s], and how far what forces follow is behind [rad].
#[derive(Clone, Copy, Debug)]
struct Followed {
    slip: f64,
    rate: f64,
    behind: f64,
}

impl Relaxed {
    /// Rates of the followed slips [rad/s] at the next sample, `dt_s` after the last: slips [rad] and their rates [rad/s], the speed
    /// \[m/s\] and the distance \[m\], which is positive. At the first sample forces follow at the slip's own rate.
    pub fn rates(
        &mut self,
        slip: [f64; 2],
        rate: [f64; 2],
        v: f64,
        dt_s: f64,
        distance: f64,
    ) -> [f64; 2] {
        let per_s = v / distance;
        let behind = |k: usize| match &self.last {
            None => rate[k] / per_s,
            Some(last) => {
                let then = &last[k];
                let grown = (slip[k] - then.slip) / dt_s;
                let of = [then.rate, grown, rate[k]];
                then.behind * (-per_s * dt_s).exp() + dt_s * gathered(of, per_s * dt_s)
            }
        };
        let now = [0, 1].map(|k| Followed {
            slip: slip[k],
            rate: rate[k],
            behind: behind(k),
        });
        self.last = Some(now);
        now.map(|now| per_s * now.behind)
    }
}

/// The integral of the cubic's slope times `e^(-x (1 - u))` over u from 0 to 1, the slopes at the start, on the mean and at the end given.
fn gathered([start, mean, end]: [f64; 3], x: f64) -> f64 {
    /// Below it the recursion loses digits.
    const SMALL: f64 = 0.02;
    let [one, u, squared] = match x < SMALL {
        true => [
            1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x / 24.0)),
            1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)),
            1.0 / 3.0 - x * (1.0 / 12.0 - x * (1.0 / 60.0 - x / 360.0)),
        ],
        false => {
            let one = -(-x).exp_m1() / x;
            let u = (1.0 - one) / x;
            [one, u, (1.0 - 2.0 * u) / x]
        }
    };
    start * one
        + (6.0 * mean - 4.0 * start - 2.0 * end) * u
        + (3.0 * (start + end) - 6.0 * mean) * squared
}

#[cfg(test)]
mod tests {
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
