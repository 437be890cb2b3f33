//! Model discrepancy over place: a random effect that is common to all runs of a track.
//!
//! On track t the rows of balance c contain `d_tc(s)`, a cubic spline with independent normal
//! coefficients whose standard deviation depends on the balance. With D the columns of all
//! coefficients in units of it, the residuals r in fits and scores have the covariance V of
//!
//! ```text
//! r = J b + D u + e,   u ~ N(0, 1)        V = 1 + D D'
//! ```
//!
//! An effect is then tested against any other error at the same places: differences between runs
//! and places are evidence of it, repetitions of the same misfit are not.
//!
//! Source: M. C. Kennedy, A. O'Hagan, Bayesian calibration of computer models, Journal of the Royal
//! Statistical Society B 63 (2001) 425; P. H. C. Eilers, B. D. Marx, Flexible smoothing with
//! B-splines and penalties, Statistical Science 11 (1996) 89.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::evidence::runs::model::repeatable::Means;
use crate::evidence::runs::model::residual_model::{BALANCES, ChannelRows};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::gram::squares;

/// Mean over place of the sum of the squares of all splines: 151/315.
const SUM_OF_SQUARES: f64 = 151.0 / 315.0;

/// The splines of a track.
#[derive(Clone, Debug, PartialEq)]
struct Span {
    track: String,
    /// Start of the first piece \[m\].
    from_m: f64,
    /// Splines of a balance.
    splines: usize,
}

/// The discrepancy of every track and balance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Discrepancy {
    spans: Arc<[Span]>,
    /// Length of a piece \[m\].
    knots_m: f64,
    /// Standard deviation of the coefficients of each balance, in its unit; 0 if nothing repeats.
    sd: [f64; BALANCES],
    /// Coefficients in standard deviations, by track and balance.
    pub sizes: Vec<f64>,
    /// Whether the coefficients are fixed in fits.
    fixed: bool,
}

impl Discrepancy {
    /// Estimates the variance of each balance: the mean product of two runs at the same place, less
    /// that of simulated runs, in which only noisy inputs repeat.
    pub fn estimate(
        frames: &[Frame],
        [rows, simulated]: [&[ChannelRows]; 2],
        used: &[bool],
        knots_m: f64,
    ) -> Self {
        let mut spans: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for frame in frames {
            let ends = spans
                .entry(&frame.track)
                .or_insert([f64::INFINITY, f64::NEG_INFINITY]);
            for s in frame.rows(&frame.s) {
                *ends = [ends[0].min(s), ends[1].max(s)];
            }
        }
        let span = |(track, [from, to]): (&str, [f64; 2])| Span {
            track: track.to_owned(),
            from_m: from,
            splines: ((to - from) / knots_m).ceil().max(1.0) as usize + 3,
        };
        let repeatable = |c, rows| Means::new(c, frames, rows, 0.5 * knots_m).repeatable(None);
        let variance = |c: usize| repeatable(c, rows) - repeatable(c, simulated).max(0.0);
        let variance = |c: usize| if used[c] { variance(c) } else { 0.0 };
        let spans = spans.into_iter().filter(|(_, [from, to])| from <= to);
        Self {
            spans: spans.map(span).collect(),
            knots_m,
            sd: std::array::from_fn(|c| (variance(c).max(0.0) / SUM_OF_SQUARES).sqrt()),
            sizes: Vec::new(),
            fixed: false,
        }
        .at_zero()
    }

    /// This discrepancy with the smaller standard deviation of the two by balance, at 0.
    pub fn with_min_sd(&self, other: &Self) -> Self {
        Self {
            sd: std::array::from_fn(|c| self.sd[c].min(other.sd[c])),
            ..self.clone()
        }
        .at_zero()
    }

    /// The discrepancy with fixed or free coefficients.
    pub fn with_fixed(&self, fixed: bool) -> Self {
        Self {
            fixed,
            ..self.clone()
        }
    }

    /// The discrepancy with coefficients of 0.
    pub fn at_zero(self) -> Self {
        let splines: usize = self.spans.iter().map(|span| span.splines).sum();
        Self {
            sizes: vec![0.0; splines * self.balances().count()],
            ..self
        }
    }

    /// Balances with a discrepancy.
    fn balances(&self) -> impl Iterator<Item = usize> + '_ {
        (0..BALANCES).filter(|c| self.sd[*c] > 0.0)
    }

    pub fn count(&self) -> usize {
        self.sizes.len()
    }

    /// Number of coefficients that are fitted.
    pub fn fitted_count(&self) -> usize {
        if self.fixed { 0 } else { self.count() }
    }

    /// The first coefficient of a track and its splines.
    fn of_track(&self, track: &str) -> Option<(usize, &Span)> {
        let balances = self.balances().count();
        let at = self.spans.iter().position(|span| span.track == track)?;
        let before: usize = self.spans[..at].iter().map(|span| span.splines).sum();
        Some((before * balances, &self.spans[at]))
    }

    /// Index of the first of the four splines that are not 0 at a place, and their values.
    fn spline(&self, span: &Span, s: f64) -> (usize, [f64; 4]) {
        let u = ((s - span.from_m) / self.knots_m).clamp(0.0, (span.splines - 3) as f64);
        let first = (u as usize).min(span.splines - 4);
        let t = u - first as f64;
        let values = [
            (1.0 - t).powi(3),
            3.0 * t.powi(3) - 6.0 * t * t + 4.0,
            -3.0 * t.powi(3) + 3.0 * t * t + 3.0 * t + 1.0,
            t.powi(3),
        ];
        (first, values.map(|value| value / 6.0))
    }

    /// [`spline`](Self::spline) at each row of a run, by balance, with the values divided by the
    /// balance's relative standard deviation there.
    fn scaled_splines(&self, frame: &Frame, span: &Span) -> [Vec<(usize, [f64; 4])>; BALANCES] {
        let (places, scales) = (frame.rows(&frame.s), frame.row_scales());
        let splines: Vec<_> = places.iter().map(|s| self.spline(span, *s)).collect();
        std::array::from_fn(|c| {
            let scaled = |(i, (first, values)): (usize, &(usize, [f64; 4]))| {
                let scale = scales.get(i).map_or(1.0, |scales| scales[c]);
                (*first, values.map(|value| value / scale))
            };
            splines.iter().enumerate().map(scaled).collect()
        })
    }

    /// The discrepancy of a balance at these places of a track, in its unit; `None` if it has none.
    pub fn along(
        &self,
        track: &str,
        balance: usize,
        places: impl Iterator<Item = f64>,
    ) -> Option<Vec<f64>> {
        let (first, span) = self.of_track(track)?;
        let number = self.balances().position(|c| c == balance)?;
        let coefficients = &self.sizes[first + number * span.splines..][..span.splines];
        let value = |s: f64| {
            let (spline, values) = self.spline(span, s);
            let both = coefficients[spline..].iter().zip(values);
            self.sd[balance] * both.map(|(size, value)| size * value).sum::<f64>()
        };
        Some(places.map(value).collect())
    }

    /// Index of the first coefficient of a run's track, and the whitened columns of the track's
    /// coefficients for the run's rows, balances stacked.
    pub fn columns(&self, frame: &Frame, whitener: &Whitener) -> (usize, DMatrix<f64>) {
        let (n, used) = (frame.row_count(), whitener.count());
        let Some((first, span)) = self.of_track(&frame.track).filter(|_| self.count() > 0) else {
            return (0, DMatrix::zeros(n * used, 0));
        };
        let splines = self.scaled_splines(frame, span);
        let balances: Vec<usize> = self.balances().collect();
        let mut columns = DMatrix::zeros(n * used, balances.len() * span.splines);
        for (b, c) in balances.iter().enumerate() {
            let whitening = whitener.column(*c);
            for (block, channel) in whitener.channels().enumerate() {
                let factor = self.sd[*c] * whitening[channel];
                for (i, (spline, values)) in splines[*c].iter().enumerate() {
                    for (k, value) in values.iter().enumerate() {
                        columns[(block * n + i, b * span.splines + spline + k)] = factor * value;
                    }
                }
            }
        }
        (first, columns)
    }

    /// Products `X'X` of whitened columns, with the free coefficients' columns inserted at index
    /// `at`.
    pub fn products(
        &self,
        frame: &Frame,
        whitener: &Whitener,
        columns: &DMatrix<f64>,
        at: usize,
    ) -> DMatrix<f64> {
        let (n, m, count) = (frame.row_count(), columns.ncols(), self.fitted_count());
        let products = squares(columns);
        if count == 0 {
            return products;
        }
        let mut all = products
            .insert_rows(at, count, 0.0)
            .insert_columns(at, count, 0.0);
        let Some((first, span)) = self.of_track(&frame.track) else {
            return all;
        };
        let splines = self.scaled_splines(frame, span);
        let spline_products = |c: usize, other: usize| {
            let mut products = DMatrix::<f64>::zeros(span.splines, span.splines);
            for ((spline, values), (_, others)) in splines[c].iter().zip(&splines[other]) {
                for (a, x) in values.iter().enumerate() {
                    for (b, y) in others.iter().enumerate() {
                        products[(spline + a, spline + b)] += x * y;
                    }
                }
            }
            products
        };
        let balances: Vec<(usize, [f64; BALANCES])> = self
            .balances()
            .map(|c| (c, whitener.column(c).map(|weight| self.sd[c] * weight)))
            .collect();
        let blocks: Vec<usize> = whitener.channels().collect();
        let of_balance = |b: usize| at + first + b * span.splines;
        for (b, (c, weights)) in balances.iter().enumerate() {
            let splines = &splines[*c];
            for (b2, (other, others)) in balances.iter().enumerate().take(b + 1) {
                let factor: f64 = blocks.iter().map(|c| weights[*c] * others[*c]).sum();
                let products = spline_products(*c, *other) * factor;
                let size = (span.splines, span.splines);
                let mut copy =
                    |at, products: &DMatrix<f64>| all.view_mut(at, size).copy_from(products);
                copy((of_balance(b2), of_balance(b)), &products.transpose());
                copy((of_balance(b), of_balance(b2)), &products);
            }
            for k in 0..m {
                let mut sums = vec![0.0; span.splines];
                for (block, c) in blocks.iter().enumerate() {
                    let rows = &columns.column(k).data.into_slice()[block * n..][..n];
                    for (row, (spline, values)) in rows.iter().zip(splines) {
                        let row = weights[*c] * row;
                        for (sum, value) in sums[*spline..].iter_mut().zip(values) {
                            *sum += row * value;
                        }
                    }
                }
                let place = if k < at { k } else { k + count };
                for (j, sum) in sums.into_iter().enumerate() {
                    all[(of_balance(b) + j, place)] = sum;
                    all[(place, of_balance(b) + j)] = sum;
                }
            }
        }
        all
    }

    /// Subtracts the discrepancy from a run's rows.
    pub fn subtract(&self, frame: &Frame, rows: &mut [Vec<f64>]) {
        let places = frame.rows(&frame.s);
        for c in self.balances() {
            let along = self.along(&frame.track, c, places.iter().copied());
            for (row, value) in rows[c].iter_mut().zip(along.into_iter().flatten()) {
                *row -= value;
            }
        }
    }

    /// Decrease of the negative log-likelihood by the discrepancy, with the coefficients integrated
    /// out. With r the whitened rows of a track, it is the sum over tracks of
    ///
    /// ```text
    /// (r'D inv(D'D + 1) D'r - ln det(D'D + 1)) / 2
    /// ```
    pub fn explained(&self, frames: &[Frame], white: &[Vec<f64>], whitener: &Whitener) -> f64 {
        let mut sums: BTreeMap<&str, (DMatrix<f64>, DVector<f64>)> = BTreeMap::new();
        for (frame, rows) in frames.iter().zip(white) {
            let (_, columns) = self.columns(frame, whitener);
            let n = columns.ncols();
            let own = || (DMatrix::identity(n, n), DVector::zeros(n));
            let (products, scores) = sums.entry(&frame.track).or_insert_with(own);
            *products += columns.tr_mul(&columns);
            *scores += columns.tr_mul(&DVector::from_column_slice(rows));
        }
        let of_track = |(products, scores): (DMatrix<f64>, DVector<f64>)| {
            let root = products.cholesky()?;
            let log_root: f64 = root.l().diagonal().map(f64::ln).sum();
            Some(0.5 * scores.dot(&root.solve(&scores)) - log_root)
        };
        sums.into_values().filter_map(of_track).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::runs::recordings::smooth_run::steady_run;
    use crate::null::random::{normal, stream};

    const USED: [bool; 4] = [true, false, true, false];

    /// Six runs of 1800 m, three on each of two tracks.
    fn frames() -> Vec<Frame> {
        let of = |k: usize| {
            let mut frame = steady_run(["east", "west"][k % 2], 6000);
            frame.s.iter_mut().for_each(|s| *s += k as f64);
            frame
        };
        (0..6).map(of).collect()
    }

    /// Noise of unit variance, plus this discrepancy in two balances.
    fn rows(frames: &[Frame], discrepancy: Option<&Discrepancy>) -> Vec<ChannelRows> {
        let mut rng = stream(3, 1, 4);
        let of = |frame: &Frame| {
            let mut noise =
                || -> Vec<f64> { (0..frame.row_count()).map(|_| normal(&mut rng)).collect() };
            let mut rows = [noise(), Vec::new(), noise(), Vec::new()];
            if let Some(discrepancy) = discrepancy {
                discrepancy.subtract(frame, &mut rows);
            }
            rows
        };
        frames.iter().map(of).collect()
    }

    fn estimated(frames: &[Frame], drawn: Option<&Discrepancy>) -> Discrepancy {
        let none = vec![ChannelRows::default(); frames.len()];
        Discrepancy::estimate(frames, [&rows(frames, drawn), &none], &USED, 40.0)
    }

    /// Coefficients drawn with deviations of 2 and 5.
    fn drawn(frames: &[Frame]) -> Discrepancy {
        let mut rng = stream(9, 2, 6);
        let spans = estimated(frames, None).spans;
        let mut drawn = Discrepancy {
            spans,
            knots_m: 40.0,
            sd: [2.0, 0.0, 5.0],
            ..Discrepancy::default()
        }
        .at_zero();
        drawn.sizes.iter_mut().for_each(|x| *x = normal(&mut rng));
        drawn
    }

    #[test]
    fn products_and_rows_are_those_of_the_columns_written_out() {
        let frames = frames();
        let discrepancy = drawn(&frames);
        let all = rows(&frames, Some(&discrepancy));
        let whitener = Whitener::estimate(&frames, &all, USED);
        for (frame, of_run) in frames.iter().zip(&all) {
            let (first, own) = discrepancy.columns(frame, &whitener);
            let x = DMatrix::from_fn(own.nrows(), 3, |i, k| (0.7 * (i * (k + 1)) as f64).sin());
            let mut dense = x.clone().insert_columns(2, discrepancy.count(), 0.0);
            dense.columns_mut(2 + first, own.ncols()).copy_from(&own);
            let found = discrepancy.products(frame, &whitener, &x, 2);
            assert!((found - dense.tr_mul(&dense)).amax() < 1e-9);
            let mut less = of_run.clone();
            discrepancy.subtract(frame, &mut less);
            let sizes = &discrepancy.sizes[first..first + own.ncols()];
            let taken = own * DVector::from_column_slice(sizes);
            let [before, after] = [of_run, &less].map(|r| whitener.apply(frame, r));
            for ((before, after), taken) in before.iter().zip(&after).zip(&taken) {
                assert!((before - after - taken).abs() < 1e-9);
            }
        }
    }

    /// The mean product of some sixty places has a relative error of a fifth.
    #[test]
    fn deviations_are_those_that_coefficients_were_drawn_with() {
        let frames = frames();
        let alone = estimated(&frames, None);
        assert!(alone.sd[0] < 0.3 && alone.sd[2] < 0.3, "{:?}", alone.sd);
        let drawn = drawn(&frames);
        let found = estimated(&frames, Some(&drawn));
        for c in [0, 2] {
            assert!(
                (found.sd[c] / drawn.sd[c] - 1.0).abs() < 0.3,
                "{:?}",
                found.sd
            );
        }
        assert_eq!(found.sd[1], 0.0);
    }

    /// Compared with the explicit covariance, `V = 1 + D D'` over the runs of each track.
    #[test]
    fn coefficients_are_integrated_out() {
        let frames = frames();
        let discrepancy = drawn(&frames);
        let all = rows(&frames, Some(&discrepancy));
        let whitener = Whitener::estimate(&frames, &all, USED);
        let white: Vec<Vec<f64>> = frames
            .iter()
            .zip(&all)
            .map(|(frame, rows)| whitener.apply(frame, rows))
            .collect();
        // Two hundred rows per run, so that the covariance is small.
        let mut short = frames.clone();
        short
            .iter_mut()
            .for_each(|frame| frame.centres.truncate(60));
        let half = white[0].len() / 2;
        let cut = |rows: &Vec<f64>| [&rows[..60], &rows[half..half + 60]].concat();
        let white: Vec<Vec<f64>> = white.iter().map(cut).collect();
        let found = discrepancy.explained(&short, &white, &whitener);
        let mut direct = 0.0;
        for track in ["east", "west"] {
            let runs = || short.iter().zip(&white).filter(|(f, _)| f.track == track);
            let columns: Vec<_> = runs()
                .map(|(frame, _)| discrepancy.columns(frame, &whitener).1)
                .collect();
            let n = columns.iter().map(DMatrix::nrows).sum();
            let d = DMatrix::from_fn(n, columns[0].ncols(), |i, k| columns[i / 120][(i % 120, k)]);
            let r = DVector::from_iterator(n, runs().flat_map(|(_, rows)| rows.iter().copied()));
            let v = DMatrix::identity(n, n) + &d * d.transpose();
            let root = v.cholesky().expect("positive definite");
            let log_root: f64 = root.l().diagonal().map(f64::ln).sum();
            direct += 0.5 * r.norm_squared() - 0.5 * r.dot(&root.solve(&r)) - log_root;
        }
        assert!((found / direct - 1.0).abs() < 1e-9, "{found} {direct}");
    }
}
