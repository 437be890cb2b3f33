//! Significant residuals by bins of every column.

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use crate::evidence::runs::campaign::RunFit;
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{Bin, MAX_BIN_P_VALUE, MAX_BINS};
use crate::null::sign_flips::{MaxT, statistics};

/// A column of a run.
type ColumnOf = fn(&Frame) -> &[f64];

/// Columns of the bins.
pub const COLUMNS: [(&str, ColumnOf); 9] = [
    ("v_mps", |f| &f.v),
    ("alpha_rad", |f| &f.slip),
    ("delta_rad", |f| &f.steer),
    ("gamma_rad", |f| &f.roll_split),
    ("az_mps2", |f| &f.acceleration[2]),
    ("roll_acceleration_radps2", |f| &f.rate_slope[0]),
    ("yaw_rate_radps", |f| &f.rate[2]),
    ("t_s", |f| &f.t),
    ("s_m", |f| &f.s),
];

/// A bin of a column and one balance.
struct Cell {
    channel: usize,
    column: String,
    from: f64,
    to: f64,
    /// Sum of the whitened residuals in the bin, by run.
    scores: Vec<f64>,
    /// Mean residual of each run with rows in the bin.
    means: Vec<f64>,
}

impl Cell {
    /// The bin in the report; `None` if it is not significant or fewer than two runs have rows.
    fn reported(&self, p_value: f64) -> Option<Bin> {
        let n = self.means.len() as f64;
        if p_value > MAX_BIN_P_VALUE || n < 2.0 {
            return None;
        }
        let mean = self.means.iter().sum::<f64>() / n;
        let squares: f64 = self.means.iter().map(|m| (m - mean).powi(2)).sum();
        let (channel, unit) = CHANNEL_NAMES[self.channel];
        Some(Bin {
            channel: channel.to_owned(),
            column: self.column.clone(),
            from: self.from,
            to: self.to,
            mean,
            error: (squares / (n - 1.0) / n).sqrt(),
            unit: unit.to_owned(),
            p_value,
        })
    }
}

/// Bins of every column with a significant whitened residual: sign-flips over runs, max-T over
/// bins.
pub fn significant_bins(fit: &RunFit, frames: &[Frame], seed: u64) -> Vec<Bin> {
    let cells = cells(&fit.residual_model, &fit.whitener, frames);
    if cells.is_empty() {
        return Vec::new();
    }
    let scores = DMatrix::from_fn(cells.len(), frames.len(), |c, i| cells[c].scores[i]);
    let null = MaxT::by_sign_flips(&scores, 999, seed ^ 0xB145);
    let t = statistics(&scores);
    let reported = |(cell, t): (&Cell, &f64)| Some((t.abs(), cell.reported(null.p_value(*t))?));
    let mut bins: Vec<(f64, Bin)> = cells.iter().zip(&t).filter_map(reported).collect();
    bins.sort_by(|a, b| b.0.total_cmp(&a.0));
    bins.into_iter()
        .map(|(_, bin)| bin)
        .take(MAX_BINS)
        .collect()
}

/// Cells of equal numbers of rows: 40 of the distance along each track, 10 of other columns.
fn cells(residual_model: &ResidualModel, whitener: &Whitener, frames: &[Frame]) -> Vec<Cell> {
    let rows = residuals(residual_model, frames);
    // A bin belongs to one balance.
    let uncorrelated = whitener.uncorrelated();
    let white: Vec<Vec<f64>> = (frames.iter().zip(&rows))
        .map(|(frame, rows)| uncorrelated.apply(frame, rows))
        .collect();
    let mut cells = Vec::new();
    for (name, of) in &COLUMNS {
        let values: Vec<Vec<f64>> = frames.iter().map(|f| f.rows(of(f))).collect();
        let tracks: BTreeSet<Option<&str>> = if *name == "s_m" {
            frames.iter().map(|f| Some(f.track.as_str())).collect()
        } else {
            BTreeSet::from([None])
        };
        for track in tracks {
            let is_on = |i: &usize| track.is_none_or(|track| track == frames[*i].track);
            let on: Vec<usize> = (0..frames.len()).filter(is_on).collect();
            let mut all: Vec<f64> = on.iter().flat_map(|i| &values[*i]).copied().collect();
            all.sort_by(f64::total_cmp);
            let Some(last) = all.len().checked_sub(1) else {
                continue;
            };
            let parts = if track.is_some() { 40 } else { 10 };
            let mut edges: Vec<f64> = (0..=parts).map(|k| all[k * last / parts]).collect();
            edges.dedup();
            for pair in edges.windows(2) {
                let is_inside = |x: f64| x >= pair[0] && x < pair[1];
                for (k, channel) in whitener.channels().enumerate() {
                    let (mut scores, mut means) = (vec![0.0; frames.len()], Vec::new());
                    for &i in &on {
                        let count = white[i].len() / whitener.count();
                        let own = (0..count).filter(|j| is_inside(values[i][*j]));
                        let (score, sum, n) = own.fold((0.0, 0.0, 0.0), |(u, r, n), j| {
                            let white = white[i][k * count + j];
                            (u + white, r + rows[i][channel][j], n + 1.0)
                        });
                        scores[i] = score;
                        means.extend((n > 0.0).then(|| sum / n));
                    }
                    cells.push(Cell {
                        channel,
                        column: track.map_or((*name).to_owned(), |t| format!("{name} on {t}")),
                        from: pair[0],
                        to: pair[1],
                        scores,
                        means,
                    });
                }
            }
        }
    }
    cells
}
