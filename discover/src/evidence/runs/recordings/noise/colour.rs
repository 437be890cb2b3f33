//! Spectral model of a sensor's noise, fitted to the recordings above the frequencies of the
//! motion.
//!
//! Noise is white noise at the recorded rate that passes the sensor's first-order low pass and the
//! recorder's second-order one. The motion is represented by a steep power of the frequency:
//!
//! ```text
//! S(f) = a A(f) B(f) + c f^-q
//! A = 1/(1 + (f/knee)^2),    B = 1/(1 + (f/corner)^4)                        with a recorder's filter: no aliasing
//! A = (1 - k)^2/(1 + k^2 - 2 k cos(2 pi f dt)),    k = exp(-2 pi knee dt)    without one
//! ```
//!
//! The fit minimises the negative Whittle log-likelihood `sum_f (ln S + P/S)`, with P the
//! periodogram (P. Whittle, Ark. Mat. 2 (1953) 423): over the corners by a pattern search, over the
//! amplitudes by Fisher scoring.

use std::f64::consts::{PI, SQRT_2};

use rand::Rng;

use crate::evidence::runs::recordings::noise::periodogram::Periodogram;
use crate::null::random::normal;

/// A first-order and a second-order low pass; an infinite corner (cutoff frequency) passes
/// everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Corner of the noise's own low pass \[Hz\].
    pub knee_hz: f64,
    /// Corner of the recorder's Butterworth filter \[Hz\].
    pub corner_hz: f64,
}

/// Initial step of the corners, as a factor.
const STEP: f64 = 1.3;
/// Final step.
const MIN_STEP: f64 = 1.01;

impl Colour {
    /// White noise.
    pub const WHITE: Self = Self {
        knee_hz: f64::INFINITY,
        corner_hz: f64::INFINITY,
    };

    /// Power at a frequency, relative to the power at frequency 0.
    fn power(self, f: f64, dt: f64) -> f64 {
        if self.corner_hz.is_finite() {
            let knee = 1.0 + (f / self.knee_hz).powi(2);
            return 1.0 / (knee * (1.0 + (f / self.corner_hz).powi(4)));
        }
        let decay = self.decay(dt);
        let turn = (2.0 * PI * f * dt).cos();
        (1.0 - decay).powi(2) / (1.0 + decay * decay - 2.0 * decay * turn)
    }

    /// `k` of the first-order low pass.
    fn decay(self, dt: f64) -> f64 {
        (-2.0 * PI * self.knee_hz * dt).exp()
    }

    /// tan(pi corner dt) of the bilinear transform; infinite above half the rate.
    fn warped(self, dt: f64) -> f64 {
        if self.corner_hz * dt < 0.5 {
            (PI * self.corner_hz * dt).tan()
        } else {
            f64::INFINITY
        }
    }

    /// Samples of noise of unit variance.
    pub fn noise(self, n: usize, dt: f64, rng: &mut impl Rng) -> Vec<f64> {
        if self == Self::WHITE {
            return (0..n).map(|_| normal(rng)).collect();
        }
        /// Samples after which the filter's initial state is negligible.
        const BEGIN: usize = 64;
        let decay = self.decay(dt);
        let over = self.variance(dt).sqrt();
        // Starts in the stationary state.
        let own = (1.0 - decay) / (over * (1.0 - decay * decay).sqrt()) * normal(rng);
        let white = (0..n + BEGIN).map(|_| normal(rng) / over);
        self.filter(white, own, dt).skip(BEGIN).collect()
    }

    /// Applies both filters; `own` is the initial state of the first.
    fn filter(
        self,
        samples: impl Iterator<Item = f64>,
        own: f64,
        dt: f64,
    ) -> impl Iterator<Item = f64> {
        let decay = self.decay(dt);
        let k = self.warped(dt);
        let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
        let (gain, a1, a2) = (
            k * k * norm,
            2.0 * (k * k - 1.0) * norm,
            (1.0 - SQRT_2 * k + k * k) * norm,
        );
        let (mut own, mut x, mut y) = (own, [0.0; 2], [0.0; 2]);
        samples.map(move |now| {
            own = decay * own + (1.0 - decay) * now;
            if k.is_infinite() {
                return own;
            }
            let out = gain * (own + 2.0 * x[0] + x[1]) - a1 * y[0] - a2 * y[1];
            (x, y) = ([own, x[0]], [out, y[0]]);
            out
        })
    }

    /// Variance of filtered white noise of unit variance at the lowest frequencies: the sum of
    /// squares of the impulse response, over some time constants of the slower filter.
    fn variance(self, dt: f64) -> f64 {
        const TIMES: f64 = 12.0;
        let slower = self.knee_hz.min(self.corner_hz);
        let samples = (TIMES / (2.0 * PI * slower * dt)).ceil() as usize + 2;
        let impulse = std::iter::once(1.0).chain(std::iter::repeat_n(0.0, samples));
        self.filter(impulse, 0.0, dt)
            .map(|response| response * response)
            .sum()
    }

    /// Colour and standard deviation of the noise above the motion; `None` if no noise is visible.
    pub fn of(seen: &Periodogram, dt: f64) -> Option<(Self, f64)> {
        let (first, last) = (*seen.frequency_hz.first()?, *seen.frequency_hz.last()?);
        let corners = |from: f64, to: f64| {
            let steps = (to / from).ln() / STEP.ln();
            let tried = (0..=steps as i32).map(move |k| from * STEP.powi(k));
            tried.chain([f64::INFINITY])
        };
        // Penalty per parameter of the Bayesian information criterion (Schwarz).
        let penalty = 0.5 * (seen.pieces * seen.power.len() as f64).ln();
        let parameter_count = |colour: &Self, power: Option<i32>| {
            let corners = [colour.knee_hz, colour.corner_hz];
            let finite = corners.iter().filter(|corner| corner.is_finite());
            finite.count() + 2 * power.iter().count()
        };
        let cost = |colour: Self, power: Option<i32>| {
            let (misfit, level) = colour.fit_amplitudes(seen, dt, power);
            let cost = seen.pieces * misfit + penalty * parameter_count(&colour, power) as f64;
            (cost, colour, level)
        };
        let smaller = |a: (f64, Self, f64), b: (f64, Self, f64)| if b.0 < a.0 { b } else { a };
        // A knee below the visible range has the slope of the motion and is not identifiable.
        let lowest = 0.5 * first;
        let knees = corners(lowest, 2.0 * last);
        let pairs = knees.flat_map(|knee_hz| {
            let corners = corners(2.0 * first, last);
            corners.map(move |corner_hz| Self { knee_hz, corner_hz })
        });
        let pairs: Vec<Self> = pairs.collect();
        let powers = [None, Some(3), Some(4), Some(6), Some(10), Some(16)];
        let best = powers.into_iter().filter_map(|power| {
            let tried = pairs.iter().map(|colour| cost(*colour, power));
            let mut best = tried.reduce(smaller)?;
            // Pattern search with decreasing steps.
            let mut step = STEP;
            while step > MIN_STEP {
                let neighbours = best.1.neighbours(step).into_iter();
                let visible = neighbours.filter(|colour| colour.knee_hz >= lowest);
                let next = visible
                    .map(|colour| cost(colour, power))
                    .fold(best, smaller);
                if next.0 >= best.0 {
                    step = step.sqrt();
                }
                best = next;
            }
            Some(best)
        });
        let best = best.reduce(smaller);
        let (_, colour, level) = best?;
        let sd = (level * colour.variance(dt) * 0.5 / dt).sqrt();
        (sd.is_finite() && sd > 0.0).then_some((colour, sd))
    }

    /// One corner changed by a factor.
    fn neighbours(self, step: f64) -> [Self; 4] {
        let scaled = |knee: f64, corner: f64| Self {
            knee_hz: knee * self.knee_hz,
            corner_hz: corner * self.corner_hz,
        };
        [
            scaled(step, 1.0),
            scaled(1.0 / step, 1.0),
            scaled(1.0, step),
            scaled(1.0, 1.0 / step),
        ]
    }

    /// Smallest misfit of this colour given the exponent of the motion, and the white noise's
    /// density.
    fn fit_amplitudes(self, seen: &Periodogram, dt: f64, power: Option<i32>) -> (f64, f64) {
        const ROUNDS: usize = 8;
        let first = seen.frequency_hz[0];
        let shapes: Vec<[f64; 2]> = seen
            .frequency_hz
            .iter()
            .map(|f| {
                let motion = power.map_or(0.0, |power| (f / first).powi(-power));
                [self.power(*f, dt), motion]
            })
            .collect();
        let spectrum = |amplitude: &[f64; 2]| {
            let [noise, motion] = *amplitude;
            let sum = move |s: &[f64; 2]| (noise * s[0] + motion * s[1]).max(1e-300);
            shapes.iter().map(sum)
        };
        let last = seen.power.len() - 1;
        let mut amplitude = [
            seen.power[last] / shapes[last][0].max(1e-300),
            seen.power[0],
        ];
        for _ in 0..ROUNDS {
            // Normal equations of least squares with weights 1 / S^2.
            let (mut diagonal, mut off_diagonal, mut right) = ([0.0; 2], 0.0, [0.0; 2]);
            for ((s, p), shape) in spectrum(&amplitude).zip(&seen.power).zip(&shapes) {
                let weight = 1.0 / (s * s);
                off_diagonal += weight * shape[0] * shape[1];
                for k in 0..2 {
                    diagonal[k] += weight * shape[k] * shape[k];
                    right[k] += weight * shape[k] * p;
                }
            }
            let determinant = diagonal[0] * diagonal[1] - off_diagonal * off_diagonal;
            let both = [
                (diagonal[1] * right[0] - off_diagonal * right[1]) / determinant,
                (diagonal[0] * right[1] - off_diagonal * right[0]) / determinant,
            ];
            amplitude = match both {
                [noise, motion] if noise > 0.0 && motion > 0.0 => both,
                [noise, _] if noise <= 0.0 => [0.0, right[1] / diagonal[1]],
                _ => [right[0] / diagonal[0], 0.0],
            };
        }
        let both = spectrum(&amplitude).zip(&seen.power);
        (both.map(|(s, p)| s.ln() + p / s).sum(), amplitude[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::stream;

    /// Noise under a motion that ends at 3 Hz: an Ornstein-Uhlenbeck process of variance 1 through
    /// x'' + sqrt 2 w x' + w^2 x = w^2 u, both in steps of a fiftieth of a row; white at the rows
    /// without a knee.
    fn columns(knee_hz: f64, corner_hz: f64, dt: f64) -> Vec<Vec<f64>> {
        const FINE: usize = 50;
        let h = dt / FINE as f64;
        (0..20)
            .map(|run| {
                let rng = &mut stream(3, 1, run);
                let w = 2.0 * PI * corner_hz;
                let (mut own, mut x, mut speed) = (normal(rng), 0.0, 0.0);
                let rows = 0..(18.0 / dt) as usize;
                rows.map(|i| {
                    if knee_hz.is_infinite() {
                        x = normal(rng);
                    } else {
                        for _ in 0..FINE {
                            let fresh = (2.0 * 2.0 * PI * knee_hz * h).sqrt() * normal(rng);
                            own += -2.0 * PI * knee_hz * h * own + fresh;
                            speed += h * (w * w * (own - x) - SQRT_2 * w * speed);
                            x += h * speed;
                        }
                    }
                    let turn = |hz: f64| (2.0 * PI * hz * i as f64 * dt + run as f64).sin();
                    let seen = if corner_hz.is_finite() || knee_hz.is_infinite() {
                        x
                    } else {
                        own
                    };
                    seen + 30.0 * turn(0.3) + 5.0 * turn(1.7) + turn(2.4)
                })
                .collect()
            })
            .collect()
    }

    #[test]
    fn power_at_the_motion_is_extrapolated_from_above() {
        let none = f64::INFINITY;
        for (knee_hz, corner_hz, dt) in [
            (none, none, 0.01),
            (5.0, none, 0.01),
            (4.85, 25.0, 0.01),
            (4.85, 40.0, 0.01),
            (8.0, 30.0, 0.004),
        ] {
            let columns = columns(knee_hz, corner_hz, dt);
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let seen = Periodogram::of(&columns, dt, 4.0).unwrap();
            let (found, sd) = Colour::of(&seen, dt).unwrap();
            // The integral of S/(1 + (f/knee)^2) is S pi knee/2, that of white noise S/(2 dt).
            let lowest = match knee_hz.is_finite() {
                true => 2.0 / (PI * knee_hz),
                false => 2.0 * dt,
            };
            let ratio = sd * sd * 2.0 * dt / found.variance(dt) / lowest;
            assert!(
                (0.75..1.33).contains(&ratio),
                "{knee_hz} {corner_hz}: {ratio} {found:?}"
            );
            assert!((0.9..1.1).contains(&sd), "{sd} {found:?}");
        }
    }

    #[test]
    fn noise_has_the_deviation_and_the_correlation_of_its_colour() {
        let dt = 0.01;
        let colour = Colour {
            knee_hz: 5.0,
            corner_hz: f64::INFINITY,
        };
        let x = colour.noise(200_000, dt, &mut stream(5, 1, 1));
        let mean = |lag: usize| {
            let pairs = x.iter().zip(&x[lag..]);
            pairs.map(|(a, b)| a * b).sum::<f64>() / (x.len() - lag) as f64
        };
        assert!((mean(0) - 1.0).abs() < 0.03);
        for lag in [1, 3] {
            let expected = (-2.0 * PI * 5.0 * dt * lag as f64).exp();
            assert!((mean(lag) - expected).abs() < 0.03);
        }
        let filtered = Colour {
            corner_hz: 20.0,
            ..colour
        };
        let x = filtered.noise(200_000, dt, &mut stream(5, 1, 2));
        let power = x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        assert!((power - 1.0).abs() < 0.03);
    }
}
