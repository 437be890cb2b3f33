//! Profile of a recorded channel: its noise, its quantisation, and where its samples are odd: leaps,
//! drop-outs, implausibly constant values.

use std::ops::Range;

use serde::Serialize;

use crate::record::gaps::{Saturation, rows_held};
use crate::record::run::Run;
use crate::series::{median, noise_sd_within};

/// Longest leap or drop-out [s]; after a longer one the channel has another level.
const MAX_LEAP_S: f64 = 0.5;
/// Quantile of the magnitudes of a channel's steps that counts as its usual step.
const USUAL_QUANTILE: f64 = 0.999;
/// Smallest size of a leap over the usual step.
const MIN_LEAP_RATIO: f64 = 5.0;
/// A constant value is implausible if the channel changes as often as this in as many samples
/// elsewhere. If changes come by chance, none comes with a probability of e^-20. Next to the
/// extremum of a smooth quantised signal there are eight at most.
const MIN_CHANGES: usize = 20;
/// A channel without noise comes to rest smoothly: the steps into and out of the rest are below this
/// part of the median step around it. With noise both are so in one case in a thousand.
const MAX_SMOOTH_STEP: f64 = 0.05;

/// Profile of a recorded channel, in its own unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Profile {
    /// Values that are NaN or empty in rows with values of other channels.
    pub missing: usize,
    /// White noise, from third differences.
    pub noise_sd: f64,
    /// Smallest difference between values, the step of a converter; absent if fewer than three in
    /// ten values equal those before.
    pub quantum: Option<f64>,
    /// Rows over which each value is repeated; absent if it is one.
    pub rows_held: Option<usize>,
    /// Longest stretch of one value [s].
    pub longest_still_s: f64,
    /// Stretches of up to half a second that leap off the values around them and back. A leap
    /// exceeds twenty standard deviations of the noise, and five times the 99.9 % quantile of the
    /// steps. A stretch of one value may instead exceed a fifth of the channel's span.
    pub leaps: usize,
    /// Leaps of several equal values: what was sent while nothing was measured.
    pub dropouts: usize,
    /// Samples at an end of its range.
    pub saturation: Option<Saturation>,
    /// Mean while the speed was 0 for a second or more: a gyroscope's bias.
    pub at_standstill: Option<f64>,
    /// Delay relative to the others, if it alone is late, and the standard error [s]; absent if
    /// the channels do not determine it within a second.
    pub delay_s: Option<[f64; 2]>,
}

impl Profile {
    /// The profile of a column in the `pieces` that are used, at a rate [Hz], and its odd samples:
    /// every leap and drop-out, the longest constant stretch of each piece, and the implausible
    /// ones.
    pub(super) fn of(
        column: &[f64],
        pieces: &[Range<usize>],
        rate_hz: f64,
    ) -> (Profile, Vec<OddSamples>) {
        let stretches = || pieces.iter().map(|piece| &column[piece.clone()]);
        let pairs = stretches().flat_map(|x| x.windows(2));
        let mut steps: Vec<f64> = pairs.map(|w| (w[1] - w[0]).abs()).collect();
        let unequal = || steps.iter().copied().filter(|step| *step != 0.0);
        let least = unequal().fold(f64::INFINITY, f64::min);
        let equal = steps.len() - unequal().count();
        let is_coarse = 10 * equal >= 3 * steps.len() && least.is_finite();
        let noise_sd = noise_sd_within(stretches());
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = stretches()
            .flatten()
            .fold(ends, |(low, high), x| (x.min(low), x.max(high)));
        let place = (USUAL_QUANTILE * steps.len() as f64) as usize;
        let usual_step = if steps.is_empty() {
            0.0
        } else {
            *steps.select_nth_unstable_by(place, f64::total_cmp).1
        };
        let min_by_noise = 20.0 * noise_sd;
        let min_leap = min_by_noise.max(MIN_LEAP_RATIO * usual_step);
        let limits = LeapLimits {
            usual_step,
            min_leap,
            // A driver's hand moves by less than a fifth of the span within a sample.
            min_leap_of_one_value: min_leap.min(min_by_noise.max(0.2 * (high - low))),
            max_samples: ((MAX_LEAP_S * rate_hz) as usize).max(1),
        };
        let in_piece = |piece: &Range<usize>| {
            let x = &column[piece.clone()];
            let mut odd = limits.leaps(x);
            odd.extend(reported_constants(x));
            for one in &mut odd {
                one.samples = one.samples.start + piece.start..one.samples.end + piece.start;
            }
            odd
        };
        let odd: Vec<OddSamples> = pieces.iter().flat_map(in_piece).collect();
        let of = |kind| odd.iter().filter(move |one| one.kind == kind);
        let longest = of(OddKind::Still).map(|one| one.samples.len()).max();
        let profile = Profile {
            noise_sd,
            quantum: is_coarse.then_some(least),
            rows_held: rows_held(stretches()),
            longest_still_s: longest.unwrap_or(0).saturating_sub(1) as f64 / rate_hz,
            leaps: of(OddKind::Leap).count(),
            dropouts: of(OddKind::DropOut).count(),
            ..Profile::default()
        };
        (profile, odd)
    }
}

/// One text for each kind of odd samples of a channel: their number, and place and evidence of the
/// first. Constant stretches that are plausible are not described.
pub(super) fn describe_odd_samples(
    run: &Run,
    column: &[f64],
    odd: &[OddSamples],
) -> Vec<(OddKind, String)> {
    let kinds = [
        (OddKind::DropOut, "drops out to one value and back"),
        (OddKind::Leap, "leaps off the values around it and back"),
        (OddKind::Still, "has one value for long"),
    ];
    let describe = |(kind, what): (OddKind, &str)| {
        let mut own = odd
            .iter()
            .filter(|one| one.kind == kind && one.is_implausible());
        let first = own.next()?.describe(run, column);
        let text = match own.count() {
            0 => first,
            more => format!("{what} {} times; {first}", more + 1),
        };
        Some((kind, text))
    };
    kinds.into_iter().filter_map(describe).collect()
}

/// Successive odd samples of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OddSamples {
    pub kind: OddKind,
    pub samples: Range<usize>,
    /// Usual step of the channel ([`USUAL_QUANTILE`]); 0 for a constant stretch.
    usual_step: f64,
    /// Least number of changes in as many samples elsewhere, for a constant stretch that is
    /// implausible; else 0.
    changes_elsewhere: usize,
}

impl OddSamples {
    /// Whether the samples themselves show a fault; a constant stretch may be plausible.
    pub fn is_implausible(&self) -> bool {
        self.kind != OddKind::Still || self.changes_elsewhere > 0
    }

    fn describe(&self, run: &Run, column: &[f64]) -> String {
        let Range { start, end } = self.samples;
        let duration_s = (end - start) as f64 * run.dt_s;
        let place = place(run, start);
        let value = column[start];
        if self.kind == OddKind::Still {
            let duration_s = duration_s - run.dt_s;
            let changes = self.changes_elsewhere;
            return format!(
                "one value for {duration_s:.2} s, {value}, from {place} on, where in as many samples elsewhere it changes {changes} times or more: frozen?"
            );
        }
        let (up, down) = (value - column[start - 1], column[end] - column[end - 1]);
        let [up, down, usual] = [up, down, self.usual_step].map(four_digits);
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

/// Time and distance of a sample in words; the distance is the integral of the speed if none is
/// recorded.
fn place(run: &Run, sample: usize) -> String {
    let t_s = run.t0_s + sample as f64 * run.dt_s;
    let recorded = run.columns.get("s_m").map(|s| s[sample]);
    let recorded = recorded.filter(|s| s.is_finite());
    match recorded.or_else(|| run.travelled_m(sample)) {
        Some(s_m) => format!("t = {t_s:.3} s (s = {s_m:.1} m)"),
        None => format!("t = {t_s:.3} s"),
    }
}

/// How the samples of a channel are odd.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OddKind {
    /// A channel has no value, or the sled is at rest: no channel is used.
    Gap,
    /// Equal values at an end of the channel's range.
    Saturated,
    /// A value or a few off those around them.
    Leap,
    /// A few equal values off those around them.
    DropOut,
    /// One value for longer than the channel's changes elsewhere make plausible; or the longest
    /// stretch of one value, if it lasts half a second or more.
    Still,
}

/// A stretch of a run in which a channel is odd.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OddStretch {
    /// The channel; empty for all.
    pub column: String,
    /// How it is odd.
    pub kind: OddKind,
    /// Time of its first sample, as recorded [s].
    pub from_s: f64,
    /// Time of its last sample [s].
    pub to_s: f64,
}

/// Which steps of a channel are leaps; sizes in the channel's unit.
struct LeapLimits {
    /// [`USUAL_QUANTILE`] of the steps.
    usual_step: f64,
    /// Smallest size of a leap to several values. It is larger than that to one value, since the
    /// onset of a force may reach a fifth of the span.
    min_leap: f64,
    /// Smallest size of a leap to one value.
    min_leap_of_one_value: f64,
    /// Most samples of a leap.
    max_samples: usize,
}

impl LeapLimits {
    /// Leaps and drop-outs. A leap ends by a step back, to nearer the value before than either step
    /// is large.
    fn leaps(&self, x: &[f64]) -> Vec<OddSamples> {
        let step = |i: usize| x[i + 1] - x[i];
        let is_far = |i: &usize| step(*i).abs() > self.min_leap_of_one_value;
        let mut leaps = Vec::new();
        let mut i = 0;
        while i + 2 < x.len() {
            let mut later = (i + 1..x.len() - 1).take(self.max_samples);
            let next = if is_far(&i) { later.find(is_far) } else { None };
            let is_equal = |j: usize| x[i + 1..=j].iter().all(|value| *value == x[i + 1]);
            let is_back = |j: &usize| {
                let smaller = step(i).abs().min(step(*j).abs());
                let returns = step(i) * step(*j) < 0.0 && (x[j + 1] - x[i]).abs() < smaller;
                returns && (smaller > self.min_leap || is_equal(*j))
            };
            let Some(last) = next.filter(is_back) else {
                i += 1;
                continue;
            };
            leaps.push(OddSamples {
                kind: if is_equal(last) && last > i + 1 {
                    OddKind::DropOut
                } else {
                    OddKind::Leap
                },
                samples: i + 1..last + 1,
                usual_step: self.usual_step,
                changes_elsewhere: 0,
            });
            i = last + 1;
        }
        leaps
    }
}

/// The implausible constant stretches, and the first of the longest.
fn reported_constants(x: &[f64]) -> Vec<OddSamples> {
    let mut all = constant_stretches(x);
    let length = |one: &OddSamples| one.samples.len();
    let longest = all.iter().map(length).max().unwrap_or(0);
    let first = all.iter().position(|one| length(one) == longest);
    let mut place = 0;
    all.retain(|one| {
        place += 1;
        Some(place - 1) == first || one.is_implausible()
    });
    all
}

/// Median magnitude of the steps that are not 0, of up to `count` samples before and after.
fn median_step(before: &[f64], after: &[f64], count: usize) -> f64 {
    let before = &before[before.len().saturating_sub(count)..];
    let pairs = before.windows(2).chain(after.windows(2).take(count));
    let steps = pairs.map(|w| (w[1] - w[0]).abs());
    median(steps.filter(|step| *step > 0.0)).unwrap_or(0.0)
}

/// Stretches of equal values, with the number of changes elsewhere if they are implausible.
fn constant_stretches(x: &[f64]) -> Vec<OddSamples> {
    let mut end = 0;
    let stretch = |equal: &[f64]| {
        let samples = end..end + equal.len();
        end = samples.end;
        OddSamples {
            kind: OddKind::Still,
            changes_elsewhere: implausible_changes(x, &samples),
            usual_step: 0.0,
            samples,
        }
    };
    x.chunk_by(|a, b| a == b).map(stretch).collect()
}

/// Largest number of samples over which a filter blurs the end of a constant stretch.
const BLURRED: usize = 30;

/// Least number of changes in as many samples as a constant stretch, next to it on either side and
/// in four of five stretches of that length: a channel that rests now and then does so again. 0 if
/// the stretch is plausible.
fn implausible_changes(x: &[f64], constant: &Range<usize>) -> usize {
    let length = constant.len();
    if length <= MIN_CHANGES {
        return 0;
    }
    let changes = |x: &[f64]| x.windows(2).filter(|w| w[0] != w[1]).count();
    let (before, after) = (&x[..constant.start], &x[constant.end..]);
    let mut earlier = before.rchunks_exact(length).map(changes);
    let mut later = after.chunks_exact(length).map(changes);
    let nearest = [earlier.next(), later.next()].into_iter().flatten().min();
    let nearest = nearest.unwrap_or_else(|| changes(before).max(changes(after)));
    if nearest < MIN_CHANGES {
        return 0;
    }
    // The channel may have been filtered after it stood still, so that its ends are blurred.
    let smooth = MAX_SMOOTH_STEP * median_step(before, after, length);
    let is_smooth = |(steps, next): (usize, &f64)| {
        (next - x[constant.start]).abs() <= smooth * (1 + steps) as f64
    };
    let mut earlier_values = before.iter().rev().take(BLURRED).enumerate();
    let mut later_values = after.iter().take(BLURRED).enumerate();
    if earlier_values.all(is_smooth) && later_values.all(is_smooth) {
        return 0;
    }
    let mut all: Vec<usize> = earlier.chain(later).chain([nearest]).collect();
    let fifth = all.len() / 5;
    let count = nearest.min(*all.select_nth_unstable(fifth).1);
    if count < MIN_CHANGES { 0 } else { count }
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
        let evident = |x: &[f64]| {
            constant_stretches(x)
                .iter()
                .filter(|one| one.is_implausible())
                .count()
        };
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
