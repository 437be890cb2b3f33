//! Profile of a recorded channel: its noise, its steps, its stretches of one value.

use std::ops::Range;

use serde::Serialize;

use crate::record::gaps::{Saturation, rows_held};
use crate::series::noise_sd_within;

/// Longest stretch of one value that is a drop-out [s]; a longer one is a channel that is constant.
const DROPOUT_S: f64 = 0.5;

/// Noise of an octave of frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Octave {
    /// Upper end [Hz]; the lower one is half of it.
    pub to_hz: f64,
    /// Standard deviation of the white noise with the same power there, in the channel's unit.
    pub sd: f64,
}

/// Profile of a recorded channel, in its own unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Profile {
    /// Values that are NaN or empty in rows that hold others.
    pub missing: usize,
    /// White noise, from third differences.
    pub noise_sd: f64,
    /// Smallest difference between values, where three in ten or more do not differ from those
    /// before: the step of a converter.
    pub quantum: Option<f64>,
    /// Rows over which each value is repeated, where it is more than one.
    pub rows_held: Option<usize>,
    /// Longest stretch of one value [s].
    pub longest_still_s: f64,
    /// Single values that leap off the line of their neighbours by more than twenty deviations of
    /// the noise and a fifth of the channel's span.
    pub leaps: usize,
    /// Stretches of up to half a second of one value that leap off that line too: what was sent
    /// while nothing was measured.
    pub dropouts: usize,
    /// Samples at an end of its range.
    pub saturation: Option<Saturation>,
    /// Mean while the speed was 0 for a second or more: a gyroscope's bias.
    pub at_standstill: Option<f64>,
    /// Delay relative to the others, if it alone is late, and the standard error [s].
    pub delay_s: Option<[f64; 2]>,
    /// Noise and motion by octave, highest first.
    pub octaves: Vec<Octave>,
}

impl Profile {
    /// Of the stretches of a channel that take part, at a rate [Hz].
    pub fn of<'a>(stretches: impl Iterator<Item = &'a [f64]> + Clone, rate_hz: f64) -> Profile {
        let pairs = || stretches.clone().flat_map(|x| x.windows(2));
        let differences = || pairs().map(|w| (w[1] - w[0]).abs());
        let (count, equal) = (pairs().count(), differences().filter(|d| *d == 0.0).count());
        let unequal = differences().filter(|d| *d != 0.0);
        let least = unequal.fold(f64::INFINITY, f64::min);
        let coarse = 10 * equal >= 3 * count && least.is_finite();
        let limits = Limits::of(stretches.clone(), rate_hz);
        let still = stretches.clone().map(|x| longest_still(x).len());
        let longest = still.max().unwrap_or(0).saturating_sub(1);
        Profile {
            noise_sd: limits.noise_sd,
            quantum: coarse.then_some(least),
            rows_held: rows_held(stretches.clone()),
            longest_still_s: longest as f64 / rate_hz,
            leaps: stretches.clone().map(|x| limits.leaps(x).count()).sum(),
            dropouts: stretches.clone().map(|x| limits.dropouts(x).len()).sum(),
            octaves: octaves(stretches, rate_hz),
            ..Profile::default()
        }
    }
}

/// From where on a value is off those next to it.
pub(super) struct Limits {
    noise_sd: f64,
    /// Least size of a leap, in the channel's unit.
    far: f64,
    /// Most samples of a drop-out.
    most: usize,
}

impl Limits {
    /// Of the stretches of a channel that take part, at a rate [Hz].
    pub(super) fn of<'a>(
        stretches: impl Iterator<Item = &'a [f64]> + Clone,
        rate_hz: f64,
    ) -> Limits {
        let noise_sd = noise_sd_within(stretches.clone());
        let ends = stretches.flatten();
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (x.min(l), x.max(h))
        });
        Limits {
            noise_sd,
            // A fifth of all that it does is more than a quick hand.
            far: (20.0 * noise_sd).max(0.2 * (high - low)),
            most: (DROPOUT_S * rate_hz) as usize,
        }
    }

    /// Samples of a stretch that leap off the line of their neighbours.
    pub(super) fn leaps<'a>(&self, x: &'a [f64]) -> impl Iterator<Item = usize> + use<'a> {
        let (noise_sd, far) = (self.noise_sd, self.far);
        let off = move |w: &[f64]| (w[1] - 0.5 * (w[0] + w[2])).abs() > far;
        let near = move |w: &[f64]| noise_sd > 0.0 && (w[2] - w[0]).abs() < 10.0 * noise_sd;
        let leaping = x.windows(3).enumerate();
        let leaping = leaping.filter(move |(_, w)| off(w) && near(w));
        leaping.map(|(i, _)| i + 1)
    }

    /// Stretches of equal values that are further off the values on either side than those are
    /// from each other.
    pub(super) fn dropouts(&self, x: &[f64]) -> Vec<Range<usize>> {
        let (mut found, mut start) = (Vec::new(), 1);
        while start < x.len() {
            let value = x[start];
            let length = x[start..].iter().take_while(|y| **y == value).count();
            let end = start + length;
            if (2..=self.most).contains(&length) && end < x.len() {
                let (before, after) = (x[start - 1], x[end]);
                let off = (value - before).abs().min((value - after).abs());
                if off > self.far && (after - before).abs() < off {
                    found.push(start..end);
                }
            }
            start = end.max(start + 1);
        }
        found
    }
}

/// The longest stretch of equal values, the first of several.
pub(super) fn longest_still(x: &[f64]) -> Range<usize> {
    let (mut longest, mut start) = (0..0, 0);
    for stretch in x.chunk_by(|a, b| a == b) {
        let end = start + stretch.len();
        if stretch.len() > longest.len() {
            longest = start..end;
        }
        start = end;
    }
    longest
}

/// Details of Haar's wavelet, octave by octave: differences of neighbouring means, so that white
/// noise gives its deviation in each.
fn octaves<'a>(stretches: impl Iterator<Item = &'a [f64]>, rate_hz: f64) -> Vec<Octave> {
    const FEWEST: usize = 16;
    const MOST: usize = 8;
    let mut levels: Vec<Vec<f64>> = stretches.map(<[f64]>::to_vec).collect();
    let mut all = Vec::new();
    let mut to_hz = 0.5 * rate_hz;
    let half = 0.5_f64.sqrt();
    for _ in 0..MOST {
        let pairs = || levels.iter().flat_map(|x| x.chunks_exact(2));
        let count = pairs().count();
        if count < FEWEST {
            break;
        }
        let squares: f64 = pairs().map(|w| (half * (w[1] - w[0])).powi(2)).sum();
        all.push(Octave {
            to_hz,
            sd: (squares / count as f64).sqrt(),
        });
        let means = |x: &Vec<f64>| x.chunks_exact(2).map(|w| half * (w[0] + w[1])).collect();
        levels = levels.iter().map(means).collect();
        to_hz *= 0.5;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_has_one_deviation_in_every_octave_and_a_converter_its_step() {
        let mut state = 7_u64;
        // Twelve even draws add up to a nearly normal one of deviation 1.
        let mut draw = || {
            let even = (0..12).map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 40) as f64 / f64::from(1 << 24)
            });
            even.sum::<f64>() - 6.0
        };
        let noise: Vec<f64> = (0..16_384).map(|_| draw()).collect();
        let expected = 1.0;
        let plain = Profile::of(std::iter::once(noise.as_slice()), 500.0);
        assert_eq!(plain.octaves.len(), 8);
        for (k, octave) in plain.octaves.iter().enumerate() {
            // Of n details the deviation is known to (2 n)^-1/2; four of these.
            let bound = 4.0 / (2.0 * 16_384.0 / f64::from(2 << k)).sqrt();
            assert!((octave.sd / expected - 1.0).abs() < bound, "{octave:?}");
        }
        // A median of so many, four deviations of it.
        assert!((plain.noise_sd / expected - 1.0).abs() < 0.05);
        assert_eq!(
            (plain.quantum, plain.leaps, plain.rows_held),
            (None, 0, None)
        );
        // The last of 101 equal values is a hundred rows after the first.
        let mut coarse: Vec<f64> = noise.iter().map(|x| (x * 0.5).round() * 0.25).collect();
        coarse[1000..1101].fill(5.0);
        let coarse = Profile::of(std::iter::once(coarse.as_slice()), 500.0);
        assert_eq!(coarse.quantum, Some(0.25));
        assert!((coarse.longest_still_s - 100.0 / 500.0).abs() < 1e-12);
        let mut leaping: Vec<f64> = (0..2000)
            .map(|i| (0.01 * f64::from(i)).sin() + 1e-2 * draw())
            .collect();
        for at in [300, 900, 1500] {
            leaping[at] += 1.0;
        }
        assert_eq!(
            Profile::of(std::iter::once(leaping.as_slice()), 500.0).leaps,
            3
        );
    }
}
