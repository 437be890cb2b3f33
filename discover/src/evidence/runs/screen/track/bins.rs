//! Residuals of runs averaged over bins of a track.

use std::collections::BTreeMap;

use crate::evidence::runs::recordings::frame::Frame;

/// A driver and the mean of one of his runs in a bin.
pub type OfDriver<'a> = (&'a str, f64);

/// Runs that a bin must have.
const LEAST_RUNS: usize = 3;

/// Means of runs by track and bin.
pub type ByBin<'a> = BTreeMap<(&'a str, i64), Vec<OfDriver<'a>>>;

/// Means of these rows of runs, by track and bin.
pub fn by_bin<'a>(frames: &'a [Frame], rows: &[Vec<f64>], width: f64) -> ByBin<'a> {
    let mut by_bin = ByBin::new();
    for (frame, rows) in frames.iter().zip(rows) {
        let mut sums: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
        for (s, r) in frame.rows(&frame.s).iter().zip(rows) {
            let (count, sum) = sums.entry((s / width).floor() as i64).or_default();
            (*count, *sum) = (*count + 1.0, *sum + r);
        }
        // Where a run begins and ends it crosses a part of a bin, and beside a gap it has a part: a mean of few samples,
        // noisier than the others.
        let mut parts: Vec<i64> = [sums.keys().next(), sums.keys().last()]
            .into_iter()
            .flatten()
            .copied()
            .collect();
        let gone = frame.rows_left_out(&frame.s);
        parts.extend(gone.iter().map(|s| (s / width).floor() as i64));
        for (bin, (count, sum)) in sums {
            if !parts.contains(&bin) {
                let runs = by_bin.entry((frame.track.as_str(), bin)).or_default();
                runs.push((frame.driver.as_str(), sum / count));
            }
        }
    }
    by_bin.retain(|_, runs| runs.len() >= LEAST_RUNS);
    by_bin
}

/// Over the runs of a bin.
pub fn mean(runs: &[OfDriver]) -> f64 {
    runs.iter().map(|(_, r)| r).sum::<f64>() / runs.len() as f64
}

/// Variance of a bin's mean by the scatter between its drivers; `None` where there is but one.
pub fn between_drivers(runs: &[OfDriver]) -> Option<f64> {
    let mut drivers: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for (driver, run) in runs {
        let sum = drivers.entry(driver).or_default();
        (sum.0, sum.1) = (sum.0 + run, sum.1 + 1.0);
    }
    let means: Vec<f64> = drivers.values().map(|(sum, count)| sum / count).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    (means.len() > 1).then(|| squares / (n - 1.0) / n)
}
