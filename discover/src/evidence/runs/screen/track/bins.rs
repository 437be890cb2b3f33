//! Residuals of runs averaged over bins of a track.

use std::collections::BTreeMap;

use crate::evidence::runs::recordings::frame::Frame;

/// A driver and the mean of one of his runs in a bin.
pub type DriverMean<'a> = (&'a str, f64);

/// Fewest runs of a bin.
const LEAST_RUNS: usize = 3;

/// Means of runs by track and bin.
pub type ByBin<'a> = BTreeMap<(&'a str, i64), Vec<DriverMean<'a>>>;

pub fn by_bin<'a>(frames: &'a [Frame], rows: &[Vec<f64>], width: f64) -> ByBin<'a> {
    let mut by_bin = ByBin::new();
    for (frame, rows) in frames.iter().zip(rows) {
        for (bin, mean) in of_run(frame, rows, width) {
            let runs = by_bin.entry((frame.track.as_str(), bin)).or_default();
            runs.push((frame.driver.as_str(), mean));
        }
    }
    by_bin.retain(|_, runs| runs.len() >= LEAST_RUNS);
    by_bin
}

/// Means of a run's rows by bin, without incomplete bins (at the ends of a run and next to a gap),
/// whose few samples are noisier.
pub fn of_run(frame: &Frame, rows: &[f64], width: f64) -> Vec<(i64, f64)> {
    let bin_of = |s: &f64| (s / width).floor() as i64;
    let mut sums: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    for (s, r) in frame.rows(&frame.s).iter().zip(rows) {
        let (count, sum) = sums.entry(bin_of(s)).or_default();
        (*count, *sum) = (*count + 1.0, *sum + r);
    }
    let ends = [sums.keys().next(), sums.keys().last()];
    let mut parts: Vec<i64> = ends.into_iter().flatten().copied().collect();
    parts.extend(frame.rows_without_gaps(&frame.s).iter().map(bin_of));
    let whole = sums.into_iter().filter(|(bin, _)| !parts.contains(bin));
    whole
        .map(|(bin, (count, sum))| (bin, sum / count))
        .collect()
}

/// Rate of the speed between the halves of each bin: with e the integral of a run's rows over time,
/// and means over the halves k,
///
/// ```text
/// (e_k+1 - e_k) / (t_k+1 - t_k)
/// ```
///
/// A mean of the rows themselves is a difference of two readings of the speed; here it is one of
/// two means of many readings.
pub fn gains(frame: &Frame, rows: &[f64], width: f64) -> Vec<(i64, f64)> {
    let t = frame.rows(&frame.t);
    let steps = t.windows(2).zip(rows.windows(2));
    let sum = steps.scan(0.0, |sum, (t, r)| {
        *sum += 0.5 * (t[1] - t[0]) * (r[0] + r[1]);
        Some(*sum)
    });
    let gained: Vec<f64> = std::iter::once(0.0).chain(sum).collect();
    let [gained, t] = [&gained, &t].map(|x| of_run(frame, x, 0.5 * width));
    let next = gained.windows(2).zip(t.windows(2));
    let neighbours = next.filter(|(e, _)| e[1].0 == e[0].0 + 1);
    neighbours
        .map(|(e, t)| (e[0].0, (e[1].1 - e[0].1) / (t[1].1 - t[0].1)))
        .collect()
}

/// The same without the bins' numbers: the rows of the track channel in comparisons of runs.
pub fn rates(frame: &Frame, rows: &[f64], width: f64) -> Vec<f64> {
    let gains = gains(frame, rows, width).into_iter();
    gains.map(|(_, rate)| rate).collect()
}

pub fn mean(runs: &[DriverMean]) -> f64 {
    runs.iter().map(|(_, r)| r).sum::<f64>() / runs.len() as f64
}

/// Variance of a bin's mean by the scatter between its drivers; `None` with a single driver.
pub fn between_drivers(runs: &[DriverMean]) -> Option<f64> {
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
