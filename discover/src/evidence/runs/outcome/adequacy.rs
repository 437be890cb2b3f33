//! How much of the misfit that repeats from run to run a model leaves.
//!
//! With r_ip the mean residual of run i in the bin p of its track, noise and everything that is a run's own
//! cancel in products of different runs:
//!
//! ```text
//! R = sum over p of w_p * mean over i != j of r_ip r_jp
//! ```
//!
//! w_p is the share of the samples that lie in the bin. What noisy inputs leave in every run alike is taken off,
//! as simulated runs of the model show it. Standard errors are by the jackknife over runs (B. Efron, C. Stein, The
//! Annals of Statistics 9 (1981) 586).

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNEL_NAMES, ChannelRows, ResidualModel,
};
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{Interval, Remaining};

/// Places that are listed of each channel.
const PLACES: usize = 3;
/// Sets of simulated runs of which the part of noisy inputs is the mean.
const SETS: u64 = 2;

/// Track and bin.
type Place<'a> = (&'a str, i64);

/// Sums of one channel's residual by place and run: sum and number of values.
struct Means<'a> {
    runs: usize,
    places: BTreeMap<Place<'a>, Vec<(usize, [f64; 2])>>,
    mean_square: f64,
}

impl<'a> Means<'a> {
    fn new(channel: usize, frames: &'a [Frame], rows: &[ChannelRows], width: f64) -> Self {
        let mut places: BTreeMap<Place, Vec<(usize, [f64; 2])>> = BTreeMap::new();
        let (mut squares, mut count) = (0.0, 0.0);
        for (i, (frame, rows)) in frames.iter().zip(rows).enumerate() {
            let mut own: BTreeMap<i64, [f64; 2]> = BTreeMap::new();
            for (s, r) in frame.rows(&frame.s).iter().zip(&rows[channel]) {
                let [sum, number] = own.entry((s / width).floor() as i64).or_default();
                (*sum, *number) = (*sum + r, *number + 1.0);
                (squares, count) = (squares + r * r, count + 1.0);
            }
            for (bin, sum) in own {
                let there = places.entry((frame.track.as_str(), bin)).or_default();
                there.push((i, sum));
            }
        }
        places.retain(|_, runs| runs.len() > 1);
        Self {
            runs: frames.len(),
            places,
            mean_square: squares / f64::max(count, 1.0),
        }
    }

    /// What repeats at one place without run `left_out`, and the number of values there.
    fn at(runs: &[(usize, [f64; 2])], left_out: Option<usize>) -> [f64; 2] {
        let (mut sum, mut squares, mut n, mut values) = (0.0, 0.0, 0.0, 0.0);
        for (_, [total, count]) in runs.iter().filter(|(i, _)| Some(*i) != left_out) {
            let mean = total / count;
            (sum, squares) = (sum + mean, squares + mean * mean);
            (n, values) = (n + 1.0, values + count);
        }
        if n > 1.0 {
            [(sum * sum - squares) / (n * (n - 1.0)), values]
        } else {
            [0.0, 0.0]
        }
    }

    /// R without a run.
    fn repeatable(&self, left_out: Option<usize>) -> f64 {
        let each = self.places.values().map(|runs| Self::at(runs, left_out));
        let [sum, values] = each.fold([0.0; 2], |[sum, values], [r, n]| [sum + n * r, values + n]);
        sum / f64::max(values, 1.0)
    }

    /// The places that hold most of R, and each one's share.
    fn places(&self, width: f64) -> Vec<String> {
        let mut each: Vec<(Place, f64)> = (self.places.iter())
            .map(|(place, runs)| {
                let [r, n] = Self::at(runs, None);
                (*place, n * r)
            })
            .collect();
        let whole: f64 = each.iter().map(|(_, r)| r).sum();
        each.sort_by(|a, b| b.1.total_cmp(&a.1));
        let text = |((track, bin), r): &(Place, f64)| {
            let from = *bin as f64 * width;
            let share = 100.0 * r / whole.max(1e-300);
            format!(
                "track {track}, s {from:.0} to {:.0} m: {share:.0} %",
                from + width
            )
        };
        each.iter().take(PLACES).map(text).collect()
    }
}

impl Campaign<'_> {
    /// What remains of the repeatable misfit of each balance given a fit with its installation errors, against that of the
    /// refitted base; nothing where a track has a single run.
    pub fn remaining(&self, base: &RunFit, last: &RunFit) -> Vec<Remaining> {
        let frames: Vec<Frame> = self.whole().iter().chain(&self.held_out).cloned().collect();
        let width = self.rules().track_bin_m;
        let rows = |model: &ResidualModel| -> Vec<ChannelRows> {
            frames
                .par_iter()
                .map(|frame| model.residuals(frame))
                .collect()
        };
        let model = &last.residual_model;
        let [before, after] = [&base.residual_model, model].map(rows);
        let simulator = self.simulator(model);
        let simulated: Vec<Vec<ChannelRows>> = (0..SETS)
            .map(|set| {
                let of = |(i, frame): (usize, &Frame)| {
                    let twin = simulator.pair(frame, model, 6_000_011 + set, i).plus;
                    model.residuals(&twin)
                };
                frames.par_iter().enumerate().map(of).collect()
            })
            .collect();
        let quantile = self.options.rules.search.interval;
        let of_channel = |c: usize| {
            let means = |rows: &[ChannelRows]| Means::new(c, &frames, rows, width);
            let own = means(&after);
            if own.places.is_empty() {
                return None;
            }
            let by_inputs = simulated.iter().map(|rows| means(rows).repeatable(None));
            let by_inputs = f64::max(by_inputs.sum::<f64>() / SETS as f64, 0.0);
            let first = (means(&before).repeatable(None) - by_inputs).max(0.0);
            let value = own.repeatable(None) - by_inputs;
            let n = own.runs as f64;
            let without: Vec<f64> = (0..own.runs).map(|i| own.repeatable(Some(i))).collect();
            let mean = without.iter().sum::<f64>() / n;
            let squares: f64 = without.iter().map(|r| (r - mean).powi(2)).sum();
            let half = quantile * ((n - 1.0) / n * squares).sqrt();
            let share = |of: f64| {
                let share = |x: f64| (x / of.max(1e-300)).clamp(0.0, 1.0);
                Interval {
                    value: share(value),
                    low: share(value - half),
                    high: share(value + half),
                }
            };
            let of_misfit = share(own.mean_square);
            Some(Remaining {
                channel: CHANNEL_NAMES[c].0.to_owned(),
                unit: CHANNEL_NAMES[c].1.to_owned(),
                repeatable: value.max(0.0).sqrt(),
                share: share(first),
                is_small: of_misfit.low <= self.options.rules.search.adequate,
                places: if of_misfit.low > 0.0 {
                    own.places(width)
                } else {
                    Vec::new()
                },
                of_misfit,
            })
        };
        let used = (0..BALANCES).filter(|c| self.used[*c]);
        used.filter_map(of_channel).collect()
    }
}
