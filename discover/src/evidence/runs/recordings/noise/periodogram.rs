//! Spectra of recorded columns, above the motion.

use std::f64::consts::PI;

/// A one-sided periodogram at evenly spaced frequencies, unit squared per hertz.
pub struct Periodogram {
    pub frequency_hz: Vec<f64>,
    /// Power spectral density.
    pub power: Vec<f64>,
    /// Effective number of independent pieces.
    pub pieces: f64,
}

/// Length of a piece [s]; frequencies are 0.4 Hz apart.
const PIECE_S: f64 = 2.5;
/// Ratio of the highest frequency to the sampling rate.
const MAX_FREQUENCY_RATIO: f64 = 0.3;
/// Smallest number of frequencies for a fit of five numbers.
const MIN_FREQUENCIES: usize = 20;

impl Periodogram {
    /// Power at the lowest frequencies.
    pub fn lowest(&self) -> f64 {
        self.power.iter().take(4).sum()
    }

    /// Welch's mean over pieces of all columns that overlap by half, with a squared Hann window
    /// (sin^4); pieces with a gap are omitted. `None` with too few frequencies or without a piece.
    pub fn of(columns: &[&[f64]], dt: f64, from_hz: f64) -> Option<Self> {
        let n = (PIECE_S / dt).round() as usize;
        let lowest = (from_hz * PIECE_S).ceil() as usize;
        let highest = (MAX_FREQUENCY_RATIO * PIECE_S / dt).floor() as usize;
        if n < 4 || highest < lowest + MIN_FREQUENCIES {
            return None;
        }
        // Frequencies above twelve times the lowest are irrelevant for the noise of the motion.
        let highest = highest.min(12 * lowest);
        let window: Vec<f64> = (0..n)
            .map(|i| (PI * (i as f64 + 0.5) / n as f64).sin().powi(4))
            .collect();
        let weight: f64 = window.iter().map(|w| w * w).sum();
        let mut power = vec![0.0; highest - lowest + 1];
        let mut pieces = 0.0;
        for column in columns {
            let is_complete = |piece: &&[f64]| piece.iter().all(|x| x.is_finite());
            for piece in column.windows(n).step_by(n / 2).filter(is_complete) {
                // The line through the ends is subtracted, so that a drift does not leak.
                let rise = (piece[n - 1] - piece[0]) / (n - 1) as f64;
                let mean = piece.iter().sum::<f64>() / n as f64;
                let middle = 0.5 * (n - 1) as f64;
                let level: Vec<f64> = piece
                    .iter()
                    .zip(&window)
                    .enumerate()
                    .map(|(i, (x, w))| w * (x - mean - rise * (i as f64 - middle)))
                    .collect();
                for (k, sums) in power.chunks_mut(LANES).enumerate() {
                    let squares = magnitudes_squared(&level, lowest + k * LANES);
                    let both = sums.iter_mut().zip(squares);
                    both.for_each(|(sum, square)| *sum += square);
                }
                pieces += 1.0;
            }
        }
        if pieces == 0.0 || power.iter().any(|p| *p <= 0.0) {
            return None;
        }
        let scale = 2.0 * dt / (weight * pieces);
        power.iter_mut().for_each(|p| *p *= scale);
        let frequency_hz = |k: usize| k as f64 / (n as f64 * dt);
        // With this window and overlap the pieces count for two thirds of independent ones.
        let pieces = 2.0 / 3.0 * pieces;
        Some(Self {
            frequency_hz: (lowest..=highest).map(frequency_hz).collect(),
            power,
            pieces,
        })
    }
}

/// Number of coefficients computed together: independent recurrences run in parallel on one core.
const LANES: usize = 8;

/// Squared magnitudes of discrete Fourier coefficients from `first` on (Goertzel's recurrence).
fn magnitudes_squared(x: &[f64], first: usize) -> [f64; LANES] {
    let angle = |k: usize| 2.0 * PI * (first + k) as f64 / x.len() as f64;
    let twice: [f64; LANES] = std::array::from_fn(|k| 2.0 * angle(k).cos());
    let (mut one, mut two) = ([0.0; LANES], [0.0; LANES]);
    for x in x {
        for k in 0..LANES {
            (one[k], two[k]) = (x + twice[k] * one[k] - two[k], one[k]);
        }
    }
    std::array::from_fn(|k| one[k] * one[k] + two[k] * two[k] - twice[k] * one[k] * two[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::{normal, stream};

    #[test]
    fn white_noise_has_its_variance_over_half_the_rate() {
        let rng = &mut stream(3, 1, 1);
        let mut x: Vec<f64> = (0..20_000).map(|_| 2.0 * normal(rng)).collect();
        // A piece with a gap is omitted, a drift is not noise.
        x[300] = f64::NAN;
        x.iter_mut()
            .enumerate()
            .for_each(|(i, x)| *x += 0.1 * i as f64);
        let seen = Periodogram::of(&[&x], 0.01, 4.0).unwrap();
        let mean = seen.power.iter().sum::<f64>() / seen.power.len() as f64;
        assert!((mean / 0.08 - 1.0).abs() < 0.06, "{mean}");
        assert_eq!(seen.frequency_hz[0], 4.0);
        assert!((seen.frequency_hz.last().unwrap() - 30.0).abs() < 0.4);
    }

    #[test]
    fn short_or_slow_recordings_have_no_colour() {
        let x = vec![1.0; 100];
        assert!(Periodogram::of(&[&x], 0.01, 4.0).is_none());
        let x = vec![1.0; 4000];
        assert!(Periodogram::of(&[&x], 0.05, 4.0).is_none());
        assert!(
            Periodogram::of(&[&x], 0.01, 4.0).is_none(),
            "no noise at all"
        );
    }
}
