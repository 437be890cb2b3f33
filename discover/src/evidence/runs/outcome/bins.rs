//! Significant residuals by bins of every column.

use nalgebra::DMatrix;

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

/// Bins of every column with a significant whitened residual: sign-flips over runs, max-T over
/// bins.
pub fn significant_bins(
    residual_model: &ResidualModel,
    whitener: &Whitener,
    frames: &[Frame],
    seed: u64,
) -> Vec<Bin> {
    struct Cell {
        channel: usize,
        column: String,
        from: f64,
        to: f64,
        u: Vec<f64>,
        sums: Vec<(f64, f64)>,
    }
    let rows = residuals(residual_model, frames);
    // A bin belongs to one balance.
    let uncorrelated = whitener.uncorrelated();
    let white: Vec<Vec<f64>> = (frames.iter().zip(&rows))
        .map(|(frame, rows)| uncorrelated.apply(frame, rows))
        .collect();
    let mut cells: Vec<Cell> = Vec::new();
    for (name, of) in &COLUMNS {
        let tracks: Vec<Option<String>> = if *name == "s_m" {
            let mut t: Vec<String> = frames.iter().map(|f| f.track.clone()).collect();
            t.sort();
            t.dedup();
            t.into_iter().map(Some).collect()
        } else {
            vec![None]
        };
        for track in tracks {
            let is_on_track = |f: &Frame| track.as_ref().is_none_or(|t| *t == f.track);
            let values: Vec<Vec<f64>> = frames.iter().map(|f| f.rows(of(f))).collect();
            let mut all: Vec<f64> = frames
                .iter()
                .zip(&values)
                .filter(|(f, _)| is_on_track(f))
                .flat_map(|(_, x)| x.iter().copied())
                .collect();
            all.sort_by(f64::total_cmp);
            let parts = if track.is_some() { 40 } else { 10 };
            let mut edges: Vec<f64> = (0..=parts)
                .map(|k| all[(k * (all.len() - 1)) / parts])
                .collect();
            edges.dedup();
            for pair in edges.windows(2) {
                for (k, channel) in whitener.channels().enumerate() {
                    let mut u = vec![0.0; frames.len()];
                    let mut sums = vec![(0.0, 0.0); frames.len()];
                    for (i, _) in frames.iter().enumerate().filter(|(_, f)| is_on_track(f)) {
                        let x = &values[i];
                        let rows_per_channel = white[i].len() / whitener.count();
                        for j in 0..rows_per_channel {
                            if x[j] >= pair[0] && x[j] < pair[1] {
                                u[i] += white[i][k * rows_per_channel + j];
                                sums[i].0 += rows[i][channel][j];
                                sums[i].1 += 1.0;
                            }
                        }
                    }
                    let label = track
                        .as_ref()
                        .map_or_else(|| (*name).to_owned(), |t| format!("{name} on {t}"));
                    cells.push(Cell {
                        channel,
                        column: label,
                        from: pair[0],
                        to: pair[1],
                        u,
                        sums,
                    });
                }
            }
        }
    }
    if cells.is_empty() {
        return Vec::new();
    }
    let u = DMatrix::from_fn(cells.len(), frames.len(), |c, i| cells[c].u[i]);
    let null = MaxT::by_sign_flips(&u, 999, seed ^ 0xB145);
    let t = statistics(&u);
    let mut out: Vec<(f64, Bin)> = cells
        .iter()
        .zip(&t)
        .filter_map(|(cell, t)| {
            let p_value = null.p_value(*t);
            let means: Vec<f64> = cell
                .sums
                .iter()
                .filter(|s| s.1 > 0.0)
                .map(|s| s.0 / s.1)
                .collect();
            let n = means.len() as f64;
            if p_value > MAX_BIN_P_VALUE || n < 2.0 {
                return None;
            }
            let mean = means.iter().sum::<f64>() / n;
            let error =
                (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
            Some((
                t.abs(),
                Bin {
                    channel: CHANNEL_NAMES[cell.channel].0.to_owned(),
                    column: cell.column.clone(),
                    from: cell.from,
                    to: cell.to,
                    mean,
                    error,
                    unit: CHANNEL_NAMES[cell.channel].1.to_owned(),
                    p_value,
                },
            ))
        })
        .collect();
    out.sort_by(|a, b| b.0.total_cmp(&a.0));
    out.into_iter().map(|(_, bin)| bin).take(MAX_BINS).collect()
}
