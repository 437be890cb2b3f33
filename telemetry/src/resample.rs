//! Resampling of series to uniform times, without values in gaps.

use kufe_sled::{MIN_FILTER_SAMPLES, Spline, low_pass};

/// Ratio of the cutoff frequency of the anti-aliasing filter to the new rate: below the Nyquist
/// ratio 0.5 by a margin for the filter's slope.
const CUTOFF_RATIO: f64 = 0.4;

/// Distance from a sample within which its value is used without interpolation [steps].
const AT_SAMPLE: f64 = 1e-3;

/// Uniform times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// First time [s].
    pub start_s: f64,
    /// Rate [Hz].
    pub rate_hz: f64,
    /// Number of times.
    pub count: usize,
}

impl Base {
    /// Time of a row [s].
    pub fn at(&self, row: usize) -> f64 {
        self.start_s + row as f64 / self.rate_hz
    }
}

/// Rows of a base in which a series has no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// First row of the gap.
    pub row: usize,
    /// Number of rows.
    pub rows: usize,
}

/// A series on a base.
#[derive(Clone, Debug, PartialEq)]
pub struct Resampled {
    /// Values at the times of the base; NaN in gaps.
    pub values: Vec<f64>,
    /// Sample rate of the series [Hz].
    pub rate_hz: f64,
    /// Cutoff frequency of the anti-aliasing filter [Hz]; `None` without filtering.
    pub filter_hz: Option<f64>,
    /// Whether values are interpolated between samples.
    pub interpolated: bool,
    /// Largest deviation of the sample times from uniform times [steps].
    pub jitter: f64,
    /// Rows without values.
    pub gaps: Vec<Gap>,
}

/// Resamples a series to a base of uniform times.
///
/// A series with a higher rate than the base is first filtered by a zero-phase Butterworth low-pass
/// filter (order 4, forwards and backwards) with a cutoff of 0.4 times the base's rate. Values
/// between samples are those of the natural cubic spline. Neither crosses a gap: rows within gaps
/// are NaN, and so are stretches that are too short for the filter (16 samples).
///
/// `time` [s] increases strictly. `None` with fewer than two finite samples.
///
/// ```
/// use kufe_telemetry::{Base, resample};
/// let t: Vec<f64> = (0..1000).map(|i| i as f64 * 0.002).collect();
/// let x: Vec<f64> = t.iter().map(|t| 3.0 * t).collect();
/// let base = Base { start_s: 0.5, rate_hz: 100.0, count: 100 };
/// let found = resample(&t, &x, &base).unwrap();
/// assert_eq!(found.filter_hz, Some(40.0));
/// assert!((found.values[50] - 3.0).abs() < 1e-9);
/// ```
pub fn resample(time: &[f64], values: &[f64], base: &Base) -> Option<Resampled> {
    let cut = stretches(time, values)?;
    // Rates follow from rounded times: 100.05 Hz counts as 100 Hz.
    let decimated = 1.0 / cut.step_s > base.rate_hz * (1.0 + 1e-3);
    let cutoff = CUTOFF_RATIO * base.rate_hz;
    let mut found = Resampled {
        values: vec![f64::NAN; base.count],
        rate_hz: 1.0 / cut.step_s,
        filter_hz: decimated.then_some(cutoff),
        interpolated: false,
        jitter: cut.jitter,
        gaps: Vec::new(),
    };
    for part in &cut.parts {
        if decimated && part.values.len() < MIN_FILTER_SAMPLES {
            continue;
        }
        let smooth = decimated.then(|| Stretch {
            values: low_pass(&part.values, 1.0 / part.step_s, cutoff),
            ..*part
        });
        found.interpolated |= place(smooth.as_ref().unwrap_or(part), base, &mut found.values);
    }
    let mut row = 0;
    while row < base.count {
        let rest = found.values[row..].iter();
        let rows = rest.take_while(|x| x.is_nan()).count();
        if rows > 0 {
            found.gaps.push(Gap { row, rows });
        }
        row += rows.max(1);
    }
    Some(found)
}

/// Writes the values of a stretch into the rows that it spans. Returns whether any row lies between
/// samples.
fn place(part: &Stretch, base: &Base, values: &mut [f64]) -> bool {
    let slack = AT_SAMPLE * part.step_s;
    let row = |t: f64| (t - base.start_s) * base.rate_hz;
    let first = row(part.start_s - slack).ceil().max(0.0);
    let last = row(part.end_s() + slack)
        .floor()
        .min(base.count as f64 - 1.0);
    if last < first {
        return false;
    }
    let rows = first as usize..=last as usize;
    let position = |row: usize| (base.at(row) - part.start_s) / part.step_s;
    let between = |p: f64| (p - p.round()).abs() > AT_SAMPLE;
    let most = (part.values.len() - 1) as f64;
    if !rows.clone().any(|row| between(position(row))) {
        for row in rows {
            values[row] = part.values[position(row).round().clamp(0.0, most) as usize];
        }
        return false;
    }
    let knots: Vec<f64> = (0..part.values.len()).map(|i| i as f64).collect();
    let spline = Spline::natural(&knots, &part.values);
    for row in rows {
        values[row] = spline.at(position(row).clamp(0.0, most))[0];
    }
    true
}

/// Ratio of a step to the longest usual step above which it is a gap. One lost sample makes 2,
/// jitter by a quarter of a step at both ends makes 1.5.
const MIN_GAP: f64 = 1.6;

/// Smallest fraction of steps within 50 % of the mean step if the series has a single rate. For two
/// merged rates the fraction is about half.
const MIN_EVEN: f64 = 0.75;

/// Quantile of the steps of merged rates that is the longest usual step.
const LONG_QUANTILE: f64 = 0.95;

/// Ratio of a step to the median above which it is not used for the mean step.
const OUTLIER: f64 = 2.5;

/// Largest deviation of a sample time from the uniform time without interpolation [steps].
const UNIFORM: f64 = 0.01;

/// Samples without a gap at uniform times.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Time of the first sample [s].
    pub start_s: f64,
    /// Time between samples [s].
    pub step_s: f64,
    /// The samples.
    pub values: Vec<f64>,
}

impl Stretch {
    /// Time of the last sample [s].
    pub fn end_s(&self) -> f64 {
        self.start_s + (self.values.len() - 1) as f64 * self.step_s
    }
}

/// Stretches of a series, and the deviation of its times from uniform times.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretches {
    /// The stretches in the order of time, each of at least two samples.
    pub parts: Vec<Stretch>,
    /// Mean time between samples, without gaps [s].
    pub step_s: f64,
    /// Largest deviation from uniform times within a stretch [steps].
    pub jitter: f64,
}

/// Splits a series at missing samples, and resamples each part to uniform times.
///
/// `time` increases strictly; values that are not finite are missing. Parts with irregular times
/// are interpolated by a cubic spline. Times that are uniform within their rounding are treated as
/// uniform. `None` with fewer than two samples.
pub(crate) fn stretches(time: &[f64], values: &[f64]) -> Option<Stretches> {
    let both = time.iter().copied().zip(values.iter().copied());
    let present = both.filter(|(t, x)| t.is_finite() && x.is_finite());
    let present: Vec<(f64, f64)> = present.collect();
    let (usual, longest) = usual_steps(&present)?;
    let resolution = resolution(&present);
    let mut parts = Vec::new();
    let mut jitter: f64 = 0.0;
    let is_gap = |pair: &[(f64, f64)]| pair[1].0 - pair[0].0 > MIN_GAP * longest;
    let cuts = (1..present.len()).filter(|&i| is_gap(&present[i - 1..=i]));
    let ends: Vec<usize> = cuts.chain([present.len()]).collect();
    let mut begin = 0;
    for end in ends {
        let part = &present[begin..end];
        begin = end;
        if part.len() < 2 {
            continue;
        }
        let (first, last) = (part[0].0, part[part.len() - 1].0);
        let step = (last - first) / (part.len() - 1) as f64;
        let deviation = |(i, (t, _)): (usize, &(f64, f64))| (t - first - i as f64 * step).abs();
        let deviation = part.iter().enumerate().map(deviation).fold(0.0, f64::max);
        let regular = deviation <= (UNIFORM * step).max(1.01 * resolution);
        jitter = jitter.max(if regular { 0.0 } else { deviation / step });
        let values = if regular {
            part.iter().map(|(_, x)| *x).collect()
        } else {
            let (knots, heights): (Vec<f64>, Vec<f64>) = part.iter().copied().unzip();
            let spline = Spline::natural(&knots, &heights);
            let value = |i| spline.at((first + i as f64 * step).min(last))[0];
            (0..part.len()).map(value).collect()
        };
        parts.push(Stretch {
            start_s: first,
            step_s: step,
            values,
        });
    }
    Some(Stretches {
        parts,
        step_s: usual,
        jitter,
    })
}

/// The usual step and the longest usual step [s].
///
/// The usual step is the mean of all steps except gaps, which averages out rounding. The longest
/// usual step equals it for a single rate; for merged rates it is a high quantile.
fn usual_steps(present: &[(f64, f64)]) -> Option<(f64, f64)> {
    let steps = present.windows(2).map(|pair| pair[1].0 - pair[0].0);
    let mut steps: Vec<f64> = steps.collect();
    steps.sort_unstable_by(f64::total_cmp);
    let below = |limit: f64| steps.partition_point(|step| *step < limit);
    let regular = below(OUTLIER * *steps.get(steps.len() / 2)?);
    let mean = steps[..regular].iter().sum::<f64>() / regular as f64;
    let even = (below(1.5 * mean) - below(0.5 * mean)) as f64 >= MIN_EVEN * steps.len() as f64;
    let quantile = steps[(LONG_QUANTILE * (steps.len() - 1) as f64) as usize];
    Some((mean, if even { mean } else { quantile }))
}

/// The largest power of ten (1 s to 1 µs) of which all times are multiples [s]; 0 without one.
fn resolution(present: &[(f64, f64)]) -> f64 {
    let multiple = |scaled: f64| {
        // Conversions of milliseconds leave rounding in the last digits.
        (scaled - scaled.round()).abs() < 1e-4_f64.max(4.0 * f64::EPSILON * scaled.abs())
    };
    let rates = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6].into_iter();
    let mut rates = rates.filter(|per_s| present.iter().all(|(t, _)| multiple(t * per_s)));
    rates.next().map_or(0.0, |per_s| 1.0 / per_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURN: f64 = std::f64::consts::TAU;

    fn series(rate: f64, seconds: f64, of: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..(rate * seconds) as usize)
            .map(|i| i as f64 / rate)
            .collect();
        let x = t.iter().map(|t| of(*t)).collect();
        (t, x)
    }

    #[test]
    fn slow_and_fast_sources_give_the_same_wave() {
        let wave = |t: f64| 2.0 + (TURN * 1.5 * t).sin();
        let base = Base {
            start_s: 1.0,
            rate_hz: 100.0,
            count: 800,
        };
        // Order 4 twice at 1.5 of 40 Hz: 1 - (0.0375)^8; a spline at f h = 1.5/20 errs by (2 pi f
        // h)^4 / 384 = 1.3e-4.
        for (rate, bound) in [
            (1000.0, 1e-6),
            (500.0, 1e-6),
            (333.0, 1e-5),
            (100.0, 1e-12),
            (20.0, 2.0e-4),
        ] {
            let (t, x) = series(rate, 10.0, wave);
            let found = resample(&t, &x, &base).unwrap();
            assert_eq!(found.filter_hz.is_some(), rate > 101.0);
            for row in 100..700 {
                let error = (found.values[row] - wave(base.at(row))).abs();
                assert!(error < bound, "{rate} Hz, row {row}: {error:.2e}");
            }
        }
    }

    #[test]
    fn what_lies_beyond_the_new_rate_does_not_come_back_as_something_slow() {
        // 97 of 500 Hz would be 3 of 100 Hz.
        let (t, x) = series(500.0, 20.0, |t| (TURN * 97.0 * t).sin());
        let base = Base {
            start_s: 1.0,
            rate_hz: 100.0,
            count: 1800,
        };
        let found = resample(&t, &x, &base).unwrap();
        let most = found.values[100..1700]
            .iter()
            .fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(most < 2e-3, "{most}");
    }

    #[test]
    fn neither_filter_nor_spline_reaches_across_a_gap() {
        // A step of 1000 behind the gap must not be felt before it.
        for rate in [500.0, 100.0, 20.0] {
            let (t, mut x) = series(rate, 10.0, |t| if t < 5.0 { 1.0 } else { 1001.0 });
            for (t, x) in t.iter().zip(&mut x) {
                if (4.9..5.2).contains(t) {
                    *x = f64::NAN;
                }
            }
            let base = Base {
                start_s: 0.0,
                rate_hz: 100.0,
                count: 950,
            };
            let found = resample(&t, &x, &base).unwrap();
            for (row, value) in found.values.iter().enumerate() {
                let t = base.at(row);
                let step = 1.0 / rate;
                if t < 4.9 - step {
                    assert!((value - 1.0).abs() < 1e-9, "{rate} Hz at {t}: {value}");
                } else if t > 5.2 + step {
                    assert!((value - 1001.0).abs() < 1e-6, "{rate} Hz at {t}: {value}");
                } else if t > 4.9 + 1e-6 && t < 5.2 - 1e-6 {
                    assert!(value.is_nan(), "{rate} Hz at {t}: {value}");
                }
            }
            assert_eq!(found.gaps.len(), 1, "{rate} Hz: {:?}", found.gaps);
        }
    }

    fn times(count: usize, step: f64) -> Vec<f64> {
        (0..count).map(|i| i as f64 * step).collect()
    }

    #[test]
    fn one_lost_sample_is_a_gap_and_rounded_times_are_none() {
        let mut x = vec![1.0; 100];
        x[40] = f64::NAN;
        let found = stretches(&times(100, 0.002), &x).unwrap();
        let lengths: Vec<usize> = found.parts.iter().map(|part| part.values.len()).collect();
        assert_eq!(lengths, [40, 59]);
        // 700 Hz written in milliseconds: steps of 1 and 2 ms.
        for rate in [700.0, 600.0, 60.0, 333.3] {
            let t: Vec<f64> = (0..500)
                .map(|i| (f64::from(i) / rate * 1e3).round() / 1e3)
                .collect();
            let found = stretches(&t, &vec![0.0; 500]).unwrap();
            assert_eq!((found.parts.len(), found.jitter), (1, 0.0), "{rate} Hz");
            assert!(
                (found.step_s * rate - 1.0).abs() < 0.01,
                "{rate} Hz: {}",
                found.step_s
            );
        }
    }

    /// Values at these times, cut into stretches: how many, and the share of the time within them.
    fn coverage(times: &[f64]) -> (usize, f64) {
        let found = stretches(times, &vec![0.0; times.len()]).unwrap();
        let within = found.parts.iter().map(|part| part.end_s() - part.start_s);
        let whole = times[times.len() - 1] - times[0];
        (found.parts.len(), within.sum::<f64>() / whole)
    }

    #[test]
    fn merged_rates_have_no_gaps_but_a_loss_of_all_rates() {
        for rates in [vec![25, 20], vec![25, 20, 12], vec![50, 50, 40, 30]] {
            // In units of 0.01 ms; each rate starts at another time.
            let own = |(k, rate): (usize, &u32)| {
                let time = move |i| 137 * k as u32 + 100_000 * i / rate;
                (0..60 * rate).map(time).collect::<Vec<u32>>()
            };
            let mut merged: Vec<u32> = rates.iter().enumerate().flat_map(own).collect();
            merged.sort_unstable();
            merged.dedup();
            let mut times: Vec<f64> = merged.iter().map(|t| f64::from(*t) * 1e-5).collect();
            assert_eq!(coverage(&times).0, 1, "{rates:?}");
            times.retain(|t| !(20.0..20.3).contains(t));
            assert_eq!(coverage(&times).0, 2, "{rates:?}");
        }
    }

    #[test]
    fn every_lost_sample_of_an_even_rate_is_a_gap() {
        for lost in [0.01, 0.1] {
            let is_lost = |i: &u32| (f64::from(*i) * 0.618_033_988_75).fract() < lost;
            let kept = (0..6000).filter(|i| !is_lost(i));
            let times: Vec<f64> = kept.map(|i| f64::from(i) * 0.01).collect();
            let lengths = times.windows(2).map(|pair| pair[1] - pair[0] > 0.015);
            let gaps = lengths.filter(|long| *long).count();
            assert_eq!(coverage(&times).0, gaps + 1, "{lost}");
        }
    }

    #[test]
    fn a_channel_in_every_tenth_row_is_a_slow_channel() {
        let x: Vec<f64> = (0..1000)
            .map(|i| if i % 10 == 3 { f64::from(i) } else { f64::NAN })
            .collect();
        let found = stretches(&times(1000, 0.01), &x).unwrap();
        assert_eq!(found.parts.len(), 1);
        assert!((found.step_s - 0.1).abs() < 1e-12);
        assert!((found.parts[0].start_s - 0.03).abs() < 1e-12);
    }

    #[test]
    fn jitter_is_taken_out_by_a_spline() {
        // Times that deviate by up to 5 % of a step with ends that do so too, not rounded; the sine's
        // own cubic spline errs by (2 pi f h)^4 / 384.
        let t: Vec<f64> = (0..2000)
            .map(|i| 0.01 * (f64::from(i) + 0.05 * (f64::from(i) * 1.7).sin()) + 1e-9 * 0.123)
            .collect();
        let wave = |t: f64| (std::f64::consts::TAU * 2.0 * t).sin();
        let x: Vec<f64> = t.iter().map(|t| wave(*t)).collect();
        let found = stretches(&t, &x).unwrap();
        assert!(
            found.jitter > 0.04 && found.jitter < 0.11,
            "{}",
            found.jitter
        );
        let part = &found.parts[0];
        let bound = 2.0 * (std::f64::consts::TAU * 2.0 * 0.01_f64).powi(4) / 384.0;
        for i in 20..1980 {
            let exact = wave(part.start_s + i as f64 * part.step_s);
            assert!((part.values[i] - exact).abs() < bound, "{i}");
        }
    }

    #[test]
    fn fewer_than_two_samples_are_nothing() {
        assert!(stretches(&[0.0], &[1.0]).is_none());
        assert!(stretches(&[0.0, 1.0], &[1.0, f64::NAN]).is_none());
    }
}
