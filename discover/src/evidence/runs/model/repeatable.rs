//! Repeatable part of a channel's residual.
//!
//! With r_ip the mean residual of run i in bin p of its track, noise and everything specific to a
//! run cancel on average in products of different runs:
//!
//! ```text
//! R = sum over p of w_p * mean over i != j of r_ip r_jp
//! ```
//!
//! w_p is the share of samples in the bin.

use std::collections::BTreeMap;

use crate::evidence::runs::model::residual_model::ChannelRows;
use crate::evidence::runs::recordings::frame::{BinSum, Frame};

/// Number of places that are reported of each channel.
const MAX_PLACES: usize = 3;

/// Track and bin.
type Place<'a> = (&'a str, i64);

/// Sums of one channel's residual by place and run: sum and number of values.
pub struct Means<'a> {
    pub runs: usize,
    /// Runs by place.
    pub places: BTreeMap<Place<'a>, Vec<(usize, BinSum)>>,
    /// Mean square of all rows.
    pub mean_square: f64,
}

impl<'a> Means<'a> {
    /// Sums of one channel in bins of this width \[m\].
    pub fn new(channel: usize, frames: &'a [Frame], rows: &[ChannelRows], width: f64) -> Self {
        let mut places: BTreeMap<Place, Vec<(usize, BinSum)>> = BTreeMap::new();
        for (i, (frame, rows)) in frames.iter().zip(rows).enumerate() {
            for (bin, sum) in frame.sums_by_bin(rows[channel].iter().copied(), width) {
                let there = places.entry((frame.track.as_str(), bin)).or_default();
                there.push((i, sum));
            }
        }
        places.retain(|_, runs| runs.len() > 1);
        let all = rows.iter().flat_map(|rows| &rows[channel]);
        let [squares, count] = all.fold([0.0; 2], |[sum, n], r| [sum + r * r, n + 1.0]);
        Self {
            runs: frames.len(),
            places,
            mean_square: squares / f64::max(count, 1.0),
        }
    }

    /// The mean product at one place without run `omitted`, and the number of values there; zeros
    /// for fewer than two runs.
    fn mean_product(runs: &[(usize, BinSum)], omitted: Option<usize>) -> [f64; 2] {
        let (mut sum, mut squares, mut n, mut values) = (0.0, 0.0, 0.0, 0.0);
        for (_, of_run) in runs.iter().filter(|(i, _)| Some(*i) != omitted) {
            let mean = of_run.mean();
            (sum, squares) = (sum + mean, squares + mean * mean);
            (n, values) = (n + 1.0, values + of_run.count);
        }
        if n > 1.0 {
            [(sum * sum - squares) / (n * (n - 1.0)), values]
        } else {
            [0.0, 0.0]
        }
    }

    /// The repeatable part R, without the run `omitted`.
    pub fn repeatable(&self, omitted: Option<usize>) -> f64 {
        let places = self.places.values();
        let each = places.map(|runs| Self::mean_product(runs, omitted));
        let [sum, values] = each.fold([0.0; 2], |[sum, values], [r, n]| [sum + n * r, values + n]);
        sum / f64::max(values, 1.0)
    }

    /// The places with the largest shares of R, in words.
    pub fn largest_places(&self, width: f64) -> Vec<String> {
        let contribution = |(place, runs): (&Place<'a>, &Vec<_>)| {
            let [r, n] = Self::mean_product(runs, None);
            (*place, n * r)
        };
        let mut each: Vec<(Place, f64)> = self.places.iter().map(contribution).collect();
        let whole: f64 = each.iter().map(|(_, r)| r).sum();
        each.sort_by(|a, b| b.1.total_cmp(&a.1));
        let text = |((track, bin), r): &(Place, f64)| {
            let from = *bin as f64 * width;
            let share = 100.0 * r / whole.max(1e-300);
            let to = from + width;
            format!("track {track}, s {from:.0} to {to:.0} m: {share:.0} %")
        };
        each.iter().take(MAX_PLACES).map(text).collect()
    }
}
