//! Profile of a recorded channel: its noise, its steps, and where it is odd: end stops, leaps,
//! drop-outs, one value for long.

use std::ops::Range;

use serde::Serialize;

use crate::record::gaps::{Saturation, rows_held};
use crate::record::run::Run;
use crate::series::{bridged, median, noise_sd_within};

/// Longest leap or drop-out [s]; after a longer one the channel has another level.
const DROPOUT_S: f64 = 0.5;
/// Share of a channel's steps that shows what is usual, and how many times as large a leap is.
const USUAL_STEPS: f64 = 0.999;
const UNUSUAL: f64 = 5.0;
/// Changes that as many samples elsewhere have where a repeated value is not plausible: if they come
/// by chance, none comes with a probability of e^-20; next to the extremum of a smooth quantised
/// signal there are eight at most.
const LEAST_CHANGES: usize = 20;
/// Steps into and out of a rest below this part of the median one around it are those of a channel
/// without noise: of noise both are in one case in a thousand.
const SMOOTH: f64 = 0.05;

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
    /// Stretches of up to half a second that leap off the values around them and back: by more than
    /// twenty deviations of the noise and five times what all but a thousandth of the steps stay
    /// below. Of one value a fifth of the channel's span is enough.
    pub leaps: usize,
    /// Those that have one value: what was sent while nothing was measured.
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
    /// of each piece the longest stretch of one value and those that are not plausible.
    pub(super) fn of(column: &[f64], pieces: &[Range<usize>], rate_hz: f64) -> (Profile, Vec<Odd>) {
        let stretches = || pieces.iter().map(|piece| &column[piece.clone()]);
        let pairs = stretches().flat_map(|x| x.windows(2));
        let mut differences: Vec<f64> = pairs.map(|w| (w[1] - w[0]).abs()).collect();
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
        let usual = (USUAL_STEPS * differences.len() as f64) as usize;
        let usual = match differences.is_empty() {
            true => 0.0,
            false => *differences.select_nth_unstable_by(usual, f64::total_cmp).1,
        };
        let noise = 20.0 * noise_sd;
        let unusual = noise.max(UNUSUAL * usual);
        let limits = Limits {
            usual,
            // A fifth of all that it does is more than a quick hand.
            far: unusual.min(noise.max(0.2 * (high - low))),
            unusual,
            most: (DROPOUT_S * rate_hz) as usize,
        };
        let in_piece = |piece: &Range<usize>| {
            let found = limits.odd(&column[piece.clone()]).into_iter();
            let start = piece.start;
            found.map(move |odd| Odd {
                at: odd.at.start + start..odd.at.end + start,
                ..odd
            })
        };
        let odd: Vec<Odd> = pieces.iter().flat_map(in_piece).collect();
        let of = |wanted| odd.iter().filter(move |one| one.kind == wanted);
        let longest = of(OddKind::Still).map(|still| still.at.len()).max();
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

/// What is odd in a channel of a run for a while and no end stop, in words, by kind: the first
/// stretch with its place and evidence, and how many there are.
pub(super) fn odd_words(run: &Run, column: &[f64], odd: &[Odd]) -> Vec<(OddKind, String)> {
    let kinds = [
        (OddKind::DropOut, "drops out to one value and back"),
        (OddKind::Leap, "leaps off the values around it and back"),
        (OddKind::Still, "has one value for long"),
    ];
    let words = |(kind, what): (OddKind, &str)| {
        let mut own = odd
            .iter()
            .filter(|one| one.kind == kind && one.is_evident());
        let first = own.next()?.describe(run, column);
        let text = match own.count() {
            0 => first,
            more => format!("{what} {} times; {first}", more + 1),
        };
        Some((kind, text))
    };
    kinds.into_iter().filter_map(words).collect()
}

/// An odd stretch of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Odd {
    pub kind: OddKind,
    pub at: Range<usize>,
    /// Of a leap the size that nearly all steps stay below; of one value the least number of
    /// changes in as many samples, 0 where it may be plausible.
    usual: f64,
}

impl Odd {
    /// Whether it is not plausible by itself.
    pub fn is_evident(&self) -> bool {
        self.kind != OddKind::Still || self.usual > 0.0
    }

    fn describe(&self, run: &Run, column: &[f64]) -> String {
        let (start, end, usual) = (self.at.start, self.at.end, self.usual);
        let duration_s = (end - start) as f64 * run.dt_s;
        let place = place(run, start);
        let from = column[start];
        if self.kind == OddKind::Still {
            let duration_s = duration_s - run.dt_s;
            return format!(
                "one value for {duration_s:.2} s, {from}, from {place} on, where in as many samples elsewhere it changes {usual} times or more: frozen?"
            );
        }
        let (up, down) = (from - column[start - 1], column[end] - column[end - 1]);
        let [up, down, usual] = [up, down, usual].map(four_digits);
        let verb = match self.kind {
            OddKind::DropOut => "drops out",
            _ => "leaps off",
        };
        format!(
            "{verb} from {place} on for {duration_s:.3} s: steps of {up} and {down}, where all but a thousandth are below {usual}"
        )
    }
}

/// A number to four significant digits.
fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// Time and distance of a sample; the distance is the integral of the speed where none is recorded.
fn place(run: &Run, sample: usize) -> String {
    let t_s = run.t0_s + sample as f64 * run.dt_s;
    let recorded = run.columns.get("s_m").map(|s| s[sample]);
    let travelled = |v: &Vec<f64>| bridged(v)[..sample].iter().sum::<f64>() * run.dt_s;
    let integral = || run.columns.get("v_mps").map(travelled);
    match recorded.filter(|s| s.is_finite()).or_else(integral) {
        Some(s_m) => format!("t = {t_s:.3} s (s = {s_m:.1} m)"),
        None => format!("t = {t_s:.3} s"),
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
    /// A value or a few off those around them.
    Leap,
    /// A few equal values off those around them.
    DropOut,
    /// One value for longer than the channel's changes elsewhere make plausible; or the longest such
    /// stretch, half a second or more.
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
    /// What nearly all steps stay below, in the channel's unit.
    usual: f64,
    /// Least size of a leap of one value, in the channel's unit.
    far: f64,
    /// Least size where it has several: a force that sets in may have a fifth of the span.
    unusual: f64,
    /// Most samples of a leap.
    most: usize,
}

impl Limits {
    /// Odd stretches of a piece: leaps, which end by a step back to nearer than either step is
    /// large, and stretches of one value.
    fn odd(&self, x: &[f64]) -> Vec<Odd> {
        let step = |i: usize| x[i + 1] - x[i];
        let leaps = |i: &usize| step(*i).abs() > self.far;
        let mut odd = Vec::new();
        let mut i = 0;
        while i + 2 < x.len() {
            let mut next = (i + 1..x.len() - 1).take(self.most.max(1));
            let next = if leaps(&i) { next.find(leaps) } else { None };
            let equal = |j: usize| x[i + 1..=j].iter().all(|value| *value == x[i + 1]);
            let is_back = |j: &usize| {
                let least = step(i).abs().min(step(*j).abs());
                let returns = step(i) * step(*j) < 0.0 && (x[j + 1] - x[i]).abs() < least;
                returns && (least > self.unusual || equal(*j))
            };
            let Some(last) = next.filter(is_back) else {
                i += 1;
                continue;
            };
            let kind = match equal(last) && last > i + 1 {
                true => OddKind::DropOut,
                false => OddKind::Leap,
            };
            odd.push(Odd {
                kind,
                at: i + 1..last + 1,
                usual: self.usual,
            });
            i = last + 1;
        }
        let stills = stills(x);
        let longest = stills.iter().map(|still| still.at.len()).max();
        let mut is_listed = false;
        odd.extend(stills.into_iter().filter(|still| {
            // The first of several.
            let first = !is_listed && Some(still.at.len()) == longest;
            is_listed |= first;
            first || still.is_evident()
        }));
        odd
    }
}

/// The median step, of those that are none of 0, of so many samples before and after.
fn usual_step(before: &[f64], after: &[f64], most: usize) -> f64 {
    let before = &before[before.len().saturating_sub(most)..];
    let pairs = before.windows(2).chain(after.windows(2).take(most));
    let steps = pairs.map(|w| (w[1] - w[0]).abs());
    median(steps.filter(|step| *step > 0.0)).unwrap_or(0.0)
}

/// Stretches of equal values, each with the least number of changes in as many samples elsewhere
/// where that makes it implausible: next to it on either side, and in four of five stretches of that
/// length, since a channel that rests now and then does so again. One without noise that comes to
/// rest smoothly has small steps at both ends.
fn stills(x: &[f64]) -> Vec<Odd> {
    let changes = |x: &[f64]| x.windows(2).filter(|w| w[0] != w[1]).count();
    let elsewhere = |at: &Range<usize>| {
        if at.len() <= LEAST_CHANGES {
            return 0;
        }
        let (before, after) = (&x[..at.start], &x[at.end..]);
        let mut left = before.rchunks_exact(at.len()).map(changes);
        let mut right = after.chunks_exact(at.len()).map(changes);
        let nearest = [left.next(), right.next()].into_iter().flatten().min();
        let near = nearest.unwrap_or_else(|| changes(before).max(changes(after)));
        if near < LEAST_CHANGES {
            return 0;
        }
        let smooth = SMOOTH * usual_step(before, after, at.len());
        let ends = [before.last(), after.first()].into_iter().flatten();
        if ends
            .map(|next| (next - x[at.start]).abs())
            .all(|step| step <= smooth)
        {
            return 0;
        }
        let mut all: Vec<usize> = left.chain(right).chain([near]).collect();
        let fifth = all.len() / 5;
        near.min(*all.select_nth_unstable(fifth).1)
    };
    let mut end = 0;
    let still = |equal: &[f64]| {
        let at = end..end + equal.len();
        end = at.end;
        let usual = Some(elsewhere(&at)).filter(|count| *count >= LEAST_CHANGES);
        Odd {
            kind: OddKind::Still,
            at,
            usual: usual.unwrap_or(0) as f64,
        }
    };
    x.chunk_by(|a, b| a == b).map(still).collect()
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

    #[test]
    fn one_value_is_implausible_by_what_the_channel_does_elsewhere() {
        let evident = |x: &[f64]| stills(x).iter().filter(|one| one.is_evident()).count();
        // Samples of a parabola in steps: near its extremum one value for 89 of 2000 samples.
        let steps = |i: i32| (1e-3 * f64::from((i - 1000) * (i - 1000))).floor();
        let smooth: Vec<f64> = (0..2000).map(steps).collect();
        assert_eq!(evident(&smooth), 0);
        // Steering that rests in every second stretch.
        let rest = |i: i32| f64::from(i * i32::from(i / 100 % 2 == 0));
        let resting: Vec<f64> = (0..2000).map(rest).collect();
        assert_eq!(evident(&resting), 0);
        // Once, but coming from it smoothly.
        let once = |i: i32| f64::from((i - 500).max(0)).powi(2) * f64::from(i % 7 + 20);
        let once: Vec<f64> = (0..2000).map(once).collect();
        assert_eq!(evident(&once), 0);
        let from_there: Vec<f64> = once.iter().map(|x| x + f64::from(*x > 0.0) * 1e8).collect();
        assert_eq!(evident(&from_there), 1);
        // A wave of which each value is repeated over ten rows, frozen for a quarter of the time.
        let wave = |i: i32| (0.01 * f64::from(i / 10)).sin();
        let mut frozen: Vec<f64> = (0..2000).map(wave).collect();
        assert_eq!(evident(&frozen), 0);
        let value = frozen[800];
        frozen[800..1300].fill(value);
        assert_eq!(evident(&frozen), 1);
    }
}
