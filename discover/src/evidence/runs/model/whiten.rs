//! Whitening of residuals across the force balances.
//!
//! The lateral and yaw balance share sensor noise, above all of the slip, so that their residuals
//! are correlated. With S the covariance of the three residuals, rows are
//!
//! ```text
//! w = L^-1 r,   L L' = S,   so that   w.w = r' S^-1 r
//! ```
//!
//! Residuals are first divided by their relative standard deviations by place
//! ([`PlaceScales`](crate::evidence::runs::recordings::place_scales::PlaceScales)).
//! Correlation in time is not removed: it is 0.1 to 0.3 at most for neighbouring rows, and none
//! beyond.

use nalgebra::Matrix3;

use crate::evidence::runs::model::residual_model::{BALANCES, CHANNELS, ChannelRows, TRACK};
use crate::evidence::runs::recordings::frame::Frame;

/// Shrinkage of the covariance of two balances, which is multiplied by 1 less this number: if two
/// residuals are identical but for rounding, their difference carries no information. Chosen: with
/// half and with twice this number two balances with a correlation of 0.84 give 2 % more and 4 %
/// less information on an effect in one of them.
const SHRINKAGE: f64 = 0.01;

/// Whitening of the residuals of several channels.
#[derive(Clone, Debug)]
pub struct Whitener {
    /// Standard deviation by channel, in the channel's unit.
    pub sd: [f64; CHANNELS],
    /// Channels in use; the track channel is treated separately.
    pub used: [bool; CHANNELS],
    /// L^-1, with 1 for an unused balance.
    root_inverse: Matrix3<f64>,
}

impl Whitener {
    /// Without scaling.
    pub fn plain(used: [bool; CHANNELS]) -> Self {
        Self {
            sd: [1.0; CHANNELS],
            used,
            root_inverse: Matrix3::identity(),
        }
    }

    /// For balances of this covariance; the track channel is not scaled.
    pub fn of(covariance: &Matrix3<f64>, used: [bool; CHANNELS]) -> Self {
        let mut whitener = Self::plain(used);
        let mut s = Matrix3::identity();
        for c in (0..BALANCES).filter(|c| used[*c] && covariance[(*c, *c)] > 0.0) {
            whitener.sd[c] = covariance[(c, c)].sqrt();
            s[(c, c)] = covariance[(c, c)];
            for other in (0..c).filter(|other| used[*other] && covariance[(*other, *other)] > 0.0) {
                let shared = (1.0 - SHRINKAGE) * covariance[(c, other)];
                (s[(c, other)], s[(other, c)]) = (shared, shared);
            }
        }
        let root = s.cholesky().and_then(|s| s.l().try_inverse());
        whitener.root_inverse = root.unwrap_or_else(|| whitener.uncorrelated().root_inverse);
        whitener
    }

    /// From the residuals of all runs.
    pub fn estimate(frames: &[Frame], rows: &[ChannelRows], used: [bool; CHANNELS]) -> Self {
        let runs = frames.iter().zip(rows);
        let scaled: Vec<ChannelRows> = runs.map(|(frame, rows)| scaled(frame, rows)).collect();
        let mut whitener = Self::of(&covariance(&scaled, used), used);
        let track = rows.iter().flat_map(|run| &run[TRACK]);
        let (sum, count) = track.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
        if sum > 0.0 {
            whitener.sd[TRACK] = f64::sqrt(sum / count);
        }
        whitener
    }

    /// This whitening without correlation between balances.
    pub fn uncorrelated(&self) -> Self {
        let inverse_sd = [0, 1, 2].map(|c| 1.0 / self.sd[c]);
        Self {
            root_inverse: Matrix3::from_diagonal(&inverse_sd.into()),
            ..self.clone()
        }
    }

    /// A whitening with the same correlation and other standard deviations.
    pub fn with_sd(&self, sd: [f64; BALANCES]) -> Self {
        let mut other = self.clone();
        for (c, sd) in sd.into_iter().enumerate() {
            let mut column = other.root_inverse.column_mut(c);
            column *= self.sd[c] / sd;
            other.sd[c] = sd;
        }
        other
    }

    /// Whitened rows of a unit residual of a balance: its column of L^-1.
    pub fn column(&self, balance: usize) -> [f64; BALANCES] {
        std::array::from_fn(|c| self.root_inverse[(c, balance)])
    }

    /// L^-1.
    pub fn root_inverse(&self) -> &Matrix3<f64> {
        &self.root_inverse
    }

    /// `ln(det S) / 2`.
    pub fn log_scale(&self) -> f64 {
        -self.root_inverse.diagonal().map(f64::ln).sum()
    }

    /// Whitens rows of the three balances in place, given their relative standard deviations
    /// ([`Frame::row_scales`]); an unused balance may be empty.
    pub fn whiten<R: AsMut<[f64]>>(&self, scales: &[[f64; 3]], rows: &mut [R; BALANCES]) {
        scale(scales, rows);
        self.decorrelate(rows);
    }

    /// Multiplies rows of equal relative standard deviations by L^-1 in place.
    pub fn decorrelate<R: AsMut<[f64]>>(&self, rows: &mut [R; BALANCES]) {
        let used = self.channels();
        let n = used.clone().map(|c| rows[c].as_mut().len()).max();
        for i in 0..n.unwrap_or(0) {
            let mut r = [0.0; BALANCES];
            for c in used.clone() {
                r[c] = rows[c].as_mut()[i];
            }
            for c in used.clone() {
                let term = |other: usize| self.root_inverse[(c, other)] * r[other];
                rows[c].as_mut()[i] = (0..=c).map(term).sum();
            }
        }
    }

    /// Whitened residuals of the channels in use; the others are empty.
    pub fn rows(&self, frame: &Frame, rows: &ChannelRows) -> ChannelRows {
        let mut rows = rows.clone();
        for (row, _) in rows.iter_mut().zip(self.used).filter(|(_, used)| !used) {
            row.clear();
        }
        let [balances @ .., track] = &mut rows;
        track.iter_mut().for_each(|r| *r /= self.sd[TRACK]);
        self.whiten(&frame.row_scales(), balances);
        rows
    }

    /// Whitened residuals of one run, all used balances concatenated.
    pub fn apply(&self, frame: &Frame, rows: &ChannelRows) -> Vec<f64> {
        let [along, side, yaw, _] = self.rows(frame, rows);
        [along, side, yaw].concat()
    }

    /// Number of balances in [`Whitener::apply`].
    pub fn count(&self) -> usize {
        self.channels().count()
    }

    /// The balances in use: the channels of the blocks of [`Whitener::apply`].
    pub fn channels(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..BALANCES).filter(|c| self.used[*c])
    }
}

/// Divides rows of balances by their relative standard deviations.
fn scale<R: AsMut<[f64]>>(scales: &[[f64; 3]], rows: &mut [R]) {
    for (i, scales) in scales.iter().enumerate() {
        for (row, scale) in rows.iter_mut().zip(scales) {
            if let Some(r) = row.as_mut().get_mut(i) {
                *r /= scale;
            }
        }
    }
}

/// Rows with the balances divided by their relative standard deviations.
pub fn scaled(frame: &Frame, rows: &ChannelRows) -> ChannelRows {
    let mut rows = rows.clone();
    scale(&frame.row_scales(), &mut rows);
    rows
}

/// Covariance of the balances in use over the rows of all runs.
pub fn covariance<'a>(
    rows: impl IntoIterator<Item = &'a ChannelRows>,
    used: [bool; CHANNELS],
) -> Matrix3<f64> {
    let (mut sums, mut counts) = (Matrix3::zeros(), Matrix3::zeros());
    let used: Vec<usize> = (0..BALANCES).filter(|c| used[*c]).collect();
    for run in rows {
        for a in &used {
            for b in &used {
                let products = run[*a].iter().zip(&run[*b]).map(|(x, y)| x * y);
                sums[(*a, *b)] += products.sum::<f64>();
                counts[(*a, *b)] += run[*a].len() as f64;
            }
        }
    }
    sums.zip_map(&counts, |sum: f64, count: f64| sum / count.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three sources of noise, two of them in two balances each.
    fn rows() -> ChannelRows {
        let source = |k: u32, i: u32| (f64::from(i * (2 * k + 1)) * 0.618 + f64::from(k)).sin();
        let row = |of: [f64; 3]| -> Vec<f64> {
            (0..5000)
                .map(|i| (0..3).map(|k| of[k as usize] * source(k, i)).sum())
                .collect()
        };
        let along = row([3.0, 0.0, 0.0]);
        let side = row([0.5, 40.0, 0.0]);
        let yaw = row([0.0, -30.0, 15.0]);
        [along, side, yaw, Vec::new()]
    }

    fn whitened(whitener: &Whitener, rows: &ChannelRows) -> ChannelRows {
        let [mut along, mut side, mut yaw, track] = rows.clone();
        whitener.decorrelate(&mut [&mut along, &mut side, &mut yaw]);
        [along, side, yaw, track]
    }

    #[test]
    fn rows_have_unit_variance_and_share_nothing() {
        let used = [true, true, true, false];
        let whitener = Whitener::of(&covariance(&[rows()], used), used);
        let white = covariance(&[whitened(&whitener, &rows())], used);
        for a in 0..3 {
            for b in 0..3 {
                let want = if a == b { 1.0 } else { 0.0 };
                assert!((white[(a, b)] - want).abs() < 0.1, "{white}");
            }
        }
        let covariance = covariance(&[rows()], used);
        let exact = 0.5 * covariance.determinant().ln();
        assert!((whitener.log_scale() - exact).abs() < 0.06);
        let louder = whitener.with_sd([0, 1, 2].map(|c| 2.0 * whitener.sd[c]));
        assert!((louder.log_scale() - whitener.log_scale() - 3.0 * 2.0_f64.ln()).abs() < 1e-12);
    }

    #[test]
    fn a_balance_that_takes_no_part_changes_nothing() {
        let used = [false, true, true, false];
        let whitener = Whitener::of(&covariance(&[rows()], used), used);
        let [mut some, all] = [rows(), rows()];
        some[0].clear();
        let [less, white] = [&some, &all].map(|rows| whitened(&whitener, rows));
        assert_eq!(less[1..3], white[1..3]);
        assert_eq!(whitener.channels().collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn identical_balances_are_not_separated_by_rounding() {
        let mut rows = rows();
        rows[2] = rows[1].iter().map(|y| 2.0 * y).collect();
        let used = [true, true, true, false];
        let whitener = Whitener::of(&covariance([&rows], used), used);
        let white = whitened(&whitener, &rows);
        assert!(
            white
                .iter()
                .flatten()
                .all(|w| w.is_finite() && w.abs() < 10.0)
        );
    }
}
