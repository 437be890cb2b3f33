//! Stretches of samples without a gap, each at a uniform rate.

use kufe_sled::Spline;

/// Steps beyond this many usual ones are gaps: one lost sample makes two, jitter by a quarter at both ends one and a half.
const GAP: f64 = 1.6;

/// Steps beyond this many medians are no samples' own.
const OUTLIER: f64 = 2.5;

/// Deviation of a time from the uniform one that is not worth an interpolation [steps].
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

/// Stretches of a series, and by how much its times stray from uniform ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretches {
    /// The stretches in time, each of two samples at least.
    pub parts: Vec<Stretch>,
    /// Usual time between samples [s].
    pub step_s: f64,
    /// Largest deviation from uniform times within a stretch [steps].
    pub jitter: f64,
}

/// Cuts a series where samples are missing and brings each part to uniform times.
///
/// `time` increases strictly; values that are not finite are missing. A cubic spline through the samples gives those of a
/// stretch whose times are irregular; where the times are uniform within what they are rounded to, they are taken as that.
/// `None` with fewer than two samples.
pub(crate) fn stretches(time: &[f64], values: &[f64]) -> Option<Stretches> {
    let present: Vec<(f64, f64)> = time
        .iter()
        .zip(values)
        .filter(|(t, x)| t.is_finite() && x.is_finite())
        .map(|(t, x)| (*t, *x))
        .collect();
    let usual = usual_step(&present)?;
    let resolution = resolution(&present);
    let mut parts = Vec::new();
    let mut jitter: f64 = 0.0;
    let is_gap = |pair: &[(f64, f64)]| pair[1].0 - pair[0].0 > GAP * usual;
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
        let stray = part
            .iter()
            .enumerate()
            .map(|(i, (t, _))| (t - first - i as f64 * step).abs());
        let stray = stray.fold(0.0, f64::max);
        let regular = stray <= (UNIFORM * step).max(1.01 * resolution);
        jitter = jitter.max(if regular { 0.0 } else { stray / step });
        let values = if regular {
            part.iter().map(|(_, x)| *x).collect()
        } else {
            let (knots, heights): (Vec<f64>, Vec<f64>) = part.iter().copied().unzip();
            let spline = Spline::natural(&knots, &heights);
            (0..part.len())
                .map(|i| spline.at((first + i as f64 * step).min(last))[0])
                .collect()
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

/// The mean of all steps but those that are gaps, whatever they are rounded to.
fn usual_step(present: &[(f64, f64)]) -> Option<f64> {
    let mut steps: Vec<f64> = present
        .windows(2)
        .map(|pair| pair[1].0 - pair[0].0)
        .collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let usual = steps.iter().filter(|step| **step < OUTLIER * median);
    let (sum, count) = usual.fold((0.0, 0), |(sum, count), step| (sum + step, count + 1));
    Some(sum / f64::from(count))
}

/// The decimal that all times are multiples of [s]; 0 where there is none.
fn resolution(present: &[(f64, f64)]) -> f64 {
    [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6]
        .into_iter()
        .find(|per_s| {
            present.iter().all(|(t, _)| {
                let scaled = t * per_s;
                // Conversions of milliseconds leave rounding in the last digits.
                (scaled - scaled.round()).abs() < 1e-4_f64.max(4.0 * f64::EPSILON * scaled.abs())
            })
        })
        .map_or(0.0, |per_s| 1.0 / per_s)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        // Times that stray by up to 5 % of a step beside ends that do so too, not rounded; the sine's own cubic spline errs by (2 pi f h)^4 / 384.
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
