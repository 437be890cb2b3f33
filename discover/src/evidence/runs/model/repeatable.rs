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
use crate::evidence::runs::recordings::frame::Frame;

/// Number of places that are reported of each channel.
const MAX_PLACES: usize = 3;

/// Track and bin.
type Place<'a> = (&'a str, i64);

/// Sums of one channel's residual by place and run: sum and number of values.
pub struct Means<'a> {
    pub runs: usize,
    /// Runs by place.
    pub places: BTreeMap<Place<'a>, Vec<(usize, [f64; 2])>>,
    /// Mean square of all rows.
    pub mean_square: f64,
}

impl<'a> Means<'a> {
    /// Sums of one channel in bins of this width \[m\].
    pub fn new(channel: usize, frames: &'a [Frame], rows: &[ChannelRows], width: f64) -> Self {
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

    /// The mean product at one place without run `omitted`, and the number of values there; zeros
    /// for fewer than two runs.
    fn mean_product(runs: &[(usize, [f64; 2])], omitted: Option<usize>) -> [f64; 2] {
        let (mut sum, mut squares, mut n, mut values) = (0.0, 0.0, 0.0, 0.0);
        for (_, [total, count]) in runs.iter().filter(|(i, _)| Some(*i) != omitted) {
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

    /// The repeatable part R, without the run `omitted`.
    pub fn repeatable(&self, omitted: Option<usize>) -> f64 {
        let each = self
            .places
            .values()
            .map(|runs| Self::mean_product(runs, omitted));
        let [sum, values] = each.fold([0.0; 2], |[sum, values], [r, n]| [sum + n * r, values + n]);
        sum / f64::max(values, 1.0)
    }

    /// The places with the largest shares of R, in words.
    pub fn largest_places(&self, width: f64) -> Vec<String> {
        let mut each: Vec<(Place, f64)> = (self.places.iter())
            .map(|(place, runs)| {
                let [r, n] = Self::mean_product(runs, None);
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
        each.iter().take(MAX_PLACES).map(text).collect()
    }
}
