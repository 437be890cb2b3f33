//! Profile of a recorded channel: its noise, its steps, and where it is odd: end stops, leaps,
//! drop-outs, one value for long.

use std::ops::Range;

use serde::Serialize;

use crate::record::gaps::{Saturation, rows_held};
use crate::series::noise_sd_within;

/// Longest stretch of one value that is a drop-out [s]; a longer one is a channel that is constant.
const DROPOUT_S: f64 = 0.5;

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
    /// Delay relative to the others, if it alone is late, and the standard error [s]; none where
    /// the channels do not determine it within a second.
    pub delay_s: Option<[f64; 2]>,
}

impl Profile {
    /// Of a column in the pieces that take part, at a rate [Hz]; with every leap and drop-out, and
    /// the longest stretch of one value of each piece.
    pub fn of(
        column: &[f64],
        pieces: &[Range<usize>],
        rate_hz: f64,
    ) -> (Profile, Vec<(OddKind, Range<usize>)>) {
        let stretches = || pieces.iter().map(|piece| &column[piece.clone()]);
        let pairs = stretches().flat_map(|x| x.windows(2));
        let differences: Vec<f64> = pairs.map(|w| (w[1] - w[0]).abs()).collect();
        let unequal = || differences.iter().copied().filter(|d| *d != 0.0);
        let least = unequal().fold(f64::INFINITY, f64::min);
        let equal = differences.len() - unequal().count();
        let coarse = 10 * equal >= 3 * differences.len() && least.is_finite();
        let noise_sd = noise_sd_within(stretches());
        let (low, high) = stretches()
            .flatten()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (x.min(l), x.max(h))
            });
        let limits = Limits {
            noise_sd,
            // A fifth of all that it does is more than a quick hand.
            far: (20.0 * noise_sd).max(0.2 * (high - low)),
            most: (DROPOUT_S * rate_hz) as usize,
        };
        let in_piece = |piece: &Range<usize>| {
            let found = limits.odd(&column[piece.clone()]).into_iter();
            let start = piece.start;
            found.map(move |(kind, x)| (kind, x.start + start..x.end + start))
        };
        let odd: Vec<(OddKind, Range<usize>)> = pieces.iter().flat_map(in_piece).collect();
        let of = |wanted| odd.iter().filter(move |(kind, _)| *kind == wanted);
        let longest = of(OddKind::Still).map(|(_, still)| still.len()).max();
        let profile = Profile {
            noise_sd,
            quantum: coarse.then_some(least),
            rows_held: rows_held(stretches()),
            longest_still_s: longest.unwrap_or(0).saturating_sub(1) as f64 / rate_hz,
            leaps: of(OddKind::Leap).count(),
            dropouts: of(OddKind::DropOut).count(),
            ..Profile::default()
        };
        (profile, odd)
    }
}

/// How a channel is odd for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OddKind {
    /// A channel has no value, or the sled is at rest: no channel takes part.
    Gap,
    /// Equal values at an end of the channel's range.
    Saturated,
    /// A single value off the line of its neighbours.
    Leap,
    /// A few equal values off that line.
    DropOut,
    /// The longest stretch of one value, half a second or more.
    Still,
}

/// A stretch of a run in which a channel is odd.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OddStretch {
    /// The channel; empty for all.
    pub column: String,
    /// How.
    pub kind: OddKind,
    /// Time of its first sample, as recorded [s].
    pub from_s: f64,
    /// Time of its last sample [s].
    pub to_s: f64,
}

/// From where on a value is off those next to it.
struct Limits {
    noise_sd: f64,
    /// Least size of a leap, in the channel's unit.
    far: f64,
    /// Most samples of a drop-out.
    most: usize,
}

impl Limits {
    /// Samples of a stretch that leap off the line of their neighbours; stretches of equal values
    /// that are further off the values on either side than those are from each other; the longest
    /// stretch of equal values, the first of several.
    fn odd(&self, x: &[f64]) -> Vec<(OddKind, Range<usize>)> {
        let off = |w: &[f64]| (w[1] - 0.5 * (w[0] + w[2])).abs() > self.far;
        let near = |w: &[f64]| self.noise_sd > 0.0 && (w[2] - w[0]).abs() < 10.0 * self.noise_sd;
        let leaping = x.windows(3).enumerate().filter(|(_, w)| off(w) && near(w));
        let mut odd: Vec<_> = leaping
            .map(|(i, _)| (OddKind::Leap, i + 1..i + 2))
            .collect();
        let (mut longest, mut start) = (0..0, 0);
        for equal in x.chunk_by(|a, b| a == b) {
            let end = start + equal.len();
            if start > 0 && end < x.len() && (2..=self.most).contains(&equal.len()) {
                let (before, after) = (x[start - 1], x[end]);
                let off = (equal[0] - before).abs().min((equal[0] - after).abs());
                if off > self.far && (after - before).abs() < off {
                    odd.push((OddKind::DropOut, start..end));
                }
            }
            if equal.len() > longest.len() {
                longest = start..end;
            }
            start = end;
        }
        odd.push((OddKind::Still, longest));
        odd
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_has_its_deviation_and_a_converter_its_step() {
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
        let of = |x: &[f64]| Profile::of(x, std::slice::from_ref(&(0..x.len())), 500.0).0;
        let plain = of(&noise);
        // A median of so many, four deviations of it.
        assert!((plain.noise_sd / expected - 1.0).abs() < 0.05);
        assert_eq!(
            (plain.quantum, plain.leaps, plain.rows_held),
            (None, 0, None)
        );
        // The last of 101 equal values is a hundred rows after the first.
        let mut coarse: Vec<f64> = noise.iter().map(|x| (x * 0.5).round() * 0.25).collect();
        coarse[1000..1101].fill(5.0);
        let coarse = of(&coarse);
        assert_eq!(coarse.quantum, Some(0.25));
        assert!((coarse.longest_still_s - 100.0 / 500.0).abs() < 1e-12);
        let mut leaping: Vec<f64> = (0..2000)
            .map(|i| (0.01 * f64::from(i)).sin() + 1e-2 * draw())
            .collect();
        for at in [300, 900, 1500] {
            leaping[at] += 1.0;
        }
        assert_eq!(of(&leaping).leaps, 3);
    }
}
