//! Residuals of runs averaged over bins of a track.

use std::collections::BTreeMap;

use crate::evidence::runs::recordings::frame::{Frame, bin_of};

/// A driver and the mean of one of his runs in a bin.
pub type DriverMean<'a> = (&'a str, f64);

/// The residual of all runs in a bin of distance.
#[derive(Clone)]
pub struct Bin {
    pub track: String,
    /// Start [m].
    pub from_m: f64,
    /// Mean over the runs [m/s2].
    pub mean: f64,
    /// Variance of the mean.
    pub variance: f64,
}

/// Smallest number of runs of a bin.
const MIN_RUNS: usize = 3;

/// Means of runs by track and bin.
pub type ByBin<'a> = BTreeMap<(&'a str, i64), Vec<DriverMean<'a>>>;

/// Means of all runs' rows by track and bin of `width` \[m\].
pub fn by_bin<'a>(frames: &'a [Frame], rows: &[Vec<f64>], width: f64) -> ByBin<'a> {
    let mut by_bin = ByBin::new();
    for (frame, rows) in frames.iter().zip(rows) {
        for (bin, mean) in of_run(frame, rows, width) {
            let runs = by_bin.entry((frame.track.as_str(), bin)).or_default();
            runs.push((frame.driver.as_str(), mean));
        }
    }
    by_bin.retain(|_, runs| runs.len() >= MIN_RUNS);
    by_bin
}

/// Means of a run's rows by bin, without incomplete bins (at the ends of a run and next to a gap),
/// whose few samples are noisier.
pub fn of_run(frame: &Frame, rows: &[f64], width: f64) -> Vec<(i64, f64)> {
    let sums = frame.sums_by_bin(rows.iter().copied(), width);
    let ends = [sums.keys().next(), sums.keys().last()];
    let mut incomplete: Vec<i64> = ends.into_iter().flatten().copied().collect();
    let omitted = frame.omitted_rows(&frame.s).into_iter();
    incomplete.extend(omitted.map(|s| bin_of(s, width)));
    let complete = sums.iter().filter(|(bin, _)| !incomplete.contains(bin));
    complete.map(|(bin, sum)| (*bin, sum.mean())).collect()
}

/// Rate of change of the speed between the halves of each bin, with the bin's number. With e the
/// integral of a run's rows over time, and e_k and t_k means over half k, it is
///
/// ```text
/// (e_k+1 - e_k) / (t_k+1 - t_k)
/// ```
///
/// The mean of the rows themselves is a difference of two single readings of the speed. This rate
/// is a difference of two means of many readings.
pub fn numbered_rates(frame: &Frame, rows: &[f64], width: f64) -> Vec<(i64, f64)> {
    let t = frame.rows(&frame.t);
    let steps = t.windows(2).zip(rows.windows(2));
    let sum = steps.scan(0.0, |sum, (t, r)| {
        *sum += 0.5 * (t[1] - t[0]) * (r[0] + r[1]);
        Some(*sum)
    });
    let integral: Vec<f64> = std::iter::once(0.0).chain(sum).collect();
    let [integral, t] = [&integral, &t].map(|x| of_run(frame, x, 0.5 * width));
    let next = integral.windows(2).zip(t.windows(2));
    let neighbours = next.filter(|(e, _)| e[1].0 == e[0].0 + 1);
    neighbours
        .map(|(e, t)| (e[0].0, (e[1].1 - e[0].1) / (t[1].1 - t[0].1)))
        .collect()
}

/// [`numbered_rates`] without the bins' numbers: the rows of the track channel in comparisons of
/// runs.
pub fn rates(frame: &Frame, rows: &[f64], width: f64) -> Vec<f64> {
    let rates = numbered_rates(frame, rows, width).into_iter();
    rates.map(|(_, rate)| rate).collect()
}

/// Mean over the runs of a bin.
pub fn mean(runs: &[DriverMean]) -> f64 {
    runs.iter().map(|(_, r)| r).sum::<f64>() / runs.len() as f64
}

/// Variance of a bin's mean from the scatter between drivers; `None` with a single driver.
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
