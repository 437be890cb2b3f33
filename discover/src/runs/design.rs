//! Directions: how the rows change with each parameter.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::chain::{BASE, Chain};
use super::data::Frame;
use super::whiten::Whitener;
use crate::score::Gram;

/// Columns that stand for each run's own level: of friction and of lateral grip.
pub const LEVELS: usize = 2;
/// Width of the narrowest window that is searched [m].
pub const BIN_M: f64 = 10.0;
/// Widths of windows in bins.
const WIDTHS: [usize; 5] = [1, 2, 4, 8, 16];

/// What is differentiated: the chain, its rows' whitening and the candidates.
pub struct Design<'a> {
    /// The model with its effects.
    pub chain: &'a Chain,
    /// The rows' whitening.
    pub whitener: &'a Whitener,
    /// Base parameters with leverage, then the active effects' amplitudes.
    pub free_base: &'a [usize],
    /// Regular candidates.
    pub candidates: &'a [Candidate],
    /// Candidates that are searched in windows.
    pub local: &'a [Candidate],
    /// The windows.
    pub windows: &'a [Window],
}

/// A stretch of a track, for one of the local candidates.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Which local candidate.
    pub local: usize,
    /// Track.
    pub track: String,
    /// From [m].
    pub from: f64,
    /// To [m].
    pub to: f64,
}

/// All windows of all widths on all tracks, half overlapping.
pub fn windows(frames: &[Frame], locals: usize) -> Vec<Window> {
    let mut tracks: Vec<(&str, f64, f64)> = Vec::new();
    for frame in frames {
        let low = frame.s.iter().copied().fold(f64::INFINITY, f64::min);
        let high = frame.s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        match tracks.iter_mut().find(|t| t.0 == frame.track) {
            Some(t) => (t.1, t.2) = (t.1.min(low), t.2.max(high)),
            None => tracks.push((&frame.track, low, high)),
        }
    }
    let mut out = Vec::new();
    for local in 0..locals {
        for (track, low, high) in &tracks {
            // Beyond 100 km a distance is a mistake that must not size anything.
            let bins = (((high - low) / BIN_M).ceil() as usize).min(10_000);
            for width in WIDTHS {
                for first in (0..bins.saturating_sub(width - 1)).step_by(width.div_ceil(2)) {
                    let from = low + first as f64 * BIN_M;
                    out.push(Window {
                        local,
                        track: (*track).to_owned(),
                        from,
                        to: from + width as f64 * BIN_M,
                    });
                }
            }
        }
    }
    out
}

impl Design<'_> {
    /// Number of fitted parameters.
    pub fn fitted(&self) -> usize {
        self.free_base.len() + self.chain.free().len()
    }

    /// Columns of one run: its levels, fitted parameters, candidates, and the residual last; all whitened.
    pub fn columns(&self, frame: &Frame) -> DMatrix<f64> {
        let rest = self.whitener.apply(&self.chain.residuals(frame));
        let direction = |chain: &Chain, step: f64| -> Vec<f64> {
            let moved = self.whitener.apply(&chain.residuals(frame));
            moved
                .iter()
                .zip(&rest)
                .map(|(m, r)| (r - m) / step)
                .collect()
        };
        let step = 1e-3;
        let base: Vec<Vec<f64>> = (0..BASE)
            .map(|b| {
                let mut chain = self.chain.clone();
                chain.base[b] += step;
                direction(&chain, step)
            })
            .collect();
        let n = rest.len();
        let grip: Vec<f64> = (0..n)
            .map(|i| base[1][i] + base[2][i] + base[3][i] + base[4][i])
            .collect();
        let mut columns: Vec<Vec<f64>> = vec![base[0].clone(), grip];
        columns.extend(self.free_base.iter().map(|b| base[*b].clone()));
        for (e, p) in self.chain.free() {
            let mut chain = self.chain.clone();
            let scale = self.scale(e, p);
            chain.effects.active[e].values[p] += 0.01 * scale;
            columns.push(direction(&chain, 0.01));
        }
        for candidate in self.candidates {
            columns.push(direction(
                &self.chain.with(candidate.active(0.01 * candidate.typical)),
                0.01,
            ));
        }
        columns.push(rest);
        let mut matrix = DMatrix::zeros(n, columns.len());
        for (k, column) in columns.iter().enumerate() {
            matrix.column_mut(k).copy_from_slice(column);
        }
        matrix
    }

    /// The unit in which an active amplitude is fitted.
    pub fn scale(&self, effect: usize, parameter: usize) -> f64 {
        let active = &self.chain.effects.active[effect];
        match &active.kind {
            kufe_sled::effects::Kind::Catalogue(kind) => kind.info().parameters[parameter].typical,
            kufe_sled::effects::Kind::Custom(_) => active.values[parameter].abs().max(1e-9),
        }
    }

    /// Sums of products of all runs, in their order.
    pub fn grams(&self, frames: &[Frame]) -> Vec<Gram> {
        frames.par_iter().map(|frame| self.gram(frame)).collect()
    }

    /// Sums of products of one run.
    pub fn gram(&self, frame: &Frame) -> Gram {
        let columns = self.columns(frame);
        let (products, norms) = self.window_products(frame, &columns);
        Gram::new(&columns, LEVELS, &products, &norms)
    }

    /// Products of the windows' directions with all columns: sums over bins, then over each window's bins.
    fn window_products(&self, frame: &Frame, columns: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
        let m = columns.ncols();
        let mut products = DMatrix::zeros(self.windows.len(), m);
        let mut norms = vec![0.0; self.windows.len()];
        if self.windows.is_empty() {
            return (products, norms);
        }
        let low = frame.s.iter().copied().fold(f64::INFINITY, f64::min);
        let own = |w: &&Window| w.track == frame.track;
        let Some(start) = self.windows.iter().find(own).map(|w| w.from) else {
            return (products, norms);
        };
        let bins = self
            .windows
            .iter()
            .filter(own)
            .map(|w| ((w.to - start) / BIN_M).round() as usize)
            .max()
            .unwrap_or(0);
        debug_assert!(low >= start - 1e-9 || !low.is_finite());
        let rest = columns.column(m - 1);
        let per_channel = columns.nrows() / self.whitener.count().max(1);
        for (l, local) in self.local.iter().enumerate() {
            let moved = self.chain.with(local.active(0.01 * local.typical));
            let moved = self.whitener.apply(&moved.residuals(frame));
            let mut sums = vec![0.0; (bins + 1) * m];
            let mut squares = vec![0.0; bins + 1];
            for (row, y) in moved.iter().enumerate() {
                let c = (rest[row] - y) / 0.01;
                if c == 0.0 {
                    continue;
                }
                let s = frame.s[row % per_channel];
                let bin = ((s - start) / BIN_M) as usize;
                if bin >= bins {
                    continue;
                }
                squares[bin + 1] += c * c;
                let sum = &mut sums[(bin + 1) * m..(bin + 2) * m];
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += c * columns[(row, k)];
                }
            }
            for bin in 1..=bins {
                squares[bin] += squares[bin - 1];
                for k in 0..m {
                    sums[bin * m + k] += sums[(bin - 1) * m + k];
                }
            }
            for (w, window) in self.windows.iter().enumerate() {
                if window.local != l || window.track != frame.track {
                    continue;
                }
                let from = ((window.from - start) / BIN_M).round() as usize;
                let to = ((window.to - start) / BIN_M).round() as usize;
                norms[w] = squares[to] - squares[from];
                for k in 0..m {
                    products[(w, k)] = sums[to * m + k] - sums[from * m + k];
                }
            }
        }
        (products, norms)
    }
}
