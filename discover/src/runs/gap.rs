//! The gap before and after, and how much of what could be explained was.

use nalgebra::DVector;
use rayon::prelude::*;

use super::chain::{CHANNEL_NAMES, CHANNELS, Chain};
use super::data::Frame;
use super::design::{Design, LEVELS};
use super::fit::{residuals, without_levels};
use super::twins::TwinMaker;
use super::whiten::Whitener;
use crate::random::{below, stream};
use crate::report::{ChannelGap, Interval};
use crate::score::ridge_inverse;

/// Root mean square by used channel before and after.
pub fn channels(
    before: &Chain,
    after: &Chain,
    frames: &[Frame],
    maker: &TwinMaker,
    used: [bool; CHANNELS],
) -> Vec<ChannelGap> {
    let rms = |chain: &Chain, frames: &[Frame], c: usize| -> f64 {
        let (sum, count) = residuals(chain, frames)
            .iter()
            .flat_map(|rows| rows[c].clone())
            .fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
        if count > 0.0 {
            f64::sqrt(sum / count)
        } else {
            0.0
        }
    };
    let sensors = {
        let mut quiet = maker.clone();
        quiet.beyond = [0.0; CHANNELS];
        quiet.make(frames, after, &residuals(after, frames), 2_000_003)
    };
    (0..CHANNELS)
        .filter(|c| used[*c])
        .map(|c| ChannelGap {
            channel: CHANNEL_NAMES[c].0.to_owned(),
            unit: CHANNEL_NAMES[c].1.to_owned(),
            before: rms(before, frames, c),
            after: rms(after, frames, c),
            noise: rms(after, &sensors, c),
        })
        .collect()
}

/// Share of the explainable gap that is closed.
///
/// On the training runs everything that any candidate direction explains of the residual before is fitted, f. On other
/// runs, whose noise is independent of f, `f . r_before` measures what is explainable there and `f . r_after` what of it
/// is left; what twins show of both (bias of noisy inputs) is taken off. The interval comes from resampling runs; it is
/// -1 to 1 where the runs hold too little that is explainable.
pub fn explainable_closed(
    before: &Design,
    after: &Chain,
    training: &[Frame],
    others: &[Frame],
    maker: &TwinMaker,
    seed: u64,
) -> Interval {
    let p = before.fitted();
    let columns: Vec<_> = training.par_iter().map(|f| before.columns(f)).collect();
    let m = columns[0].ncols() - LEVELS;
    let mut total = nalgebra::DMatrix::zeros(m, m);
    for x in &columns {
        total += without_levels(&x.tr_mul(x));
    }
    // The base's own directions are fitted along, so that f is what goes beyond them.
    let coefficients: DVector<f64> =
        (ridge_inverse(total.view((0, 0), (m - 1, m - 1)).into_owned())
            * total.view((0, m - 1), (m - 1, 1)))
        .column(0)
        .into_owned();
    let pairs = |frames: &[Frame]| -> Vec<(f64, f64)> {
        frames
            .par_iter()
            .map(|frame| {
                let x = before.columns(frame);
                let n = x.nrows();
                let own = x.columns(0, LEVELS).into_owned();
                let f: DVector<f64> =
                    x.columns(LEVELS + p, m - 1 - p) * coefficients.rows(p, m - 1 - p);
                let inverse = ridge_inverse(own.tr_mul(&own));
                let free = &f - &own * (&inverse * own.tr_mul(&f));
                let r_before = x.column(m + LEVELS - 1).into_owned();
                let r_after = DVector::from_vec(before.whitener.apply(&after.residuals(frame)));
                assert_eq!(r_after.len(), n);
                (free.dot(&r_before), free.dot(&r_after))
            })
            .collect()
    };
    let mut measured = pairs(others);
    let rows = residuals(after, others);
    let count = 8;
    for k in 0..count {
        let twin = maker.make(others, after, &rows, 3_000_017 + k);
        // In a twin of the final model nothing is left to find: both products show bias alone.
        for (pair, bias) in measured.iter_mut().zip(pairs(&twin)) {
            pair.0 -= bias.1 / count as f64;
            pair.1 -= bias.1 / count as f64;
        }
    }
    // No more than all can be closed; less than -1 says no more than "worse". Without anything explainable there: NaN.
    let closed = |picked: &mut dyn Iterator<Item = usize>| -> f64 {
        let (b, a) = picked.fold((0.0, 0.0), |(b, a), i| {
            (b + measured[i].0, a + measured[i].1)
        });
        if b > 0.0 {
            (1.0 - a / b).clamp(-1.0, 1.0)
        } else {
            f64::NAN
        }
    };
    let n = measured.len();
    let value = closed(&mut (0..n));
    let mut rng = stream(seed, 0xB007, 0);
    let mut values: Vec<f64> = (0..999)
        .map(|_| {
            let picks: Vec<usize> = (0..n).map(|_| below(&mut rng, n)).collect();
            closed(&mut picks.into_iter())
        })
        .collect();
    // Where one draw in forty explains nothing the share has no bounds: these runs cannot tell.
    if value.is_nan() || values.iter().filter(|v| v.is_nan()).count() > 24 {
        return Interval {
            value: if value.is_nan() { 0.0 } else { value },
            low: -1.0,
            high: 1.0,
        };
    }
    values.retain(|v| !v.is_nan());
    values.sort_by(f64::total_cmp);
    Interval {
        value,
        low: values[values.len() / 40],
        high: values[values.len() - 1 - values.len() / 40],
    }
}

/// Bins of every column in which the whitened residual stands out, by sign-flips over runs and max-T over all bins.
pub fn stand_out(
    chain: &Chain,
    whitener: &Whitener,
    frames: &[Frame],
    limit: f64,
    seed: u64,
) -> Vec<crate::report::Bin> {
    type ColumnOf = fn(&Frame) -> &[f64];
    let columns: [(&str, &str, ColumnOf); 9] = [
        ("v_mps", "m/s", |f| &f.v),
        ("alpha_rad", "rad", |f| &f.slip),
        ("delta_rad", "rad", |f| &f.steer),
        ("gamma_rad", "rad", |f| &f.roll_split),
        ("az_mps2", "m/s2", |f| &f.acceleration[2]),
        ("roll_acceleration_radps2", "rad/s2", |f| &f.rate_slope[0]),
        ("yaw_rate_radps", "rad/s", |f| &f.rate[2]),
        ("t_s", "s", |f| &f.t),
        ("s_m", "m", |f| &f.s),
    ];
    struct Cell {
        channel: usize,
        column: String,
        from: f64,
        to: f64,
        u: Vec<f64>,
        sums: Vec<(f64, f64)>,
    }
    let rows = residuals(chain, frames);
    let white: Vec<Vec<f64>> = rows.iter().map(|r| whitener.apply(r)).collect();
    let mut cells: Vec<Cell> = Vec::new();
    for (name, _, of) in &columns {
        let tracks: Vec<Option<String>> = if *name == "s_m" {
            let mut t: Vec<String> = frames.iter().map(|f| f.track.clone()).collect();
            t.sort();
            t.dedup();
            t.into_iter().map(Some).collect()
        } else {
            vec![None]
        };
        for track in tracks {
            let mine = |f: &Frame| track.as_ref().is_none_or(|t| *t == f.track);
            let mut all: Vec<f64> = frames
                .iter()
                .filter(|f| mine(f))
                .flat_map(|f| of(f).iter().copied())
                .collect();
            all.sort_by(f64::total_cmp);
            let parts = if track.is_some() { 40 } else { 10 };
            let mut edges: Vec<f64> = (0..=parts)
                .map(|k| all[(k * (all.len() - 1)) / parts])
                .collect();
            edges.dedup();
            for pair in edges.windows(2) {
                for k in 0..whitener.count() {
                    let channel = whitener.channel(k);
                    let mut u = vec![0.0; frames.len()];
                    let mut sums = vec![(0.0, 0.0); frames.len()];
                    for (i, frame) in frames.iter().enumerate().filter(|(_, f)| mine(f)) {
                        let x = of(frame);
                        let per = white[i].len() / whitener.count();
                        for j in 0..per {
                            if x[j] >= pair[0] && x[j] < pair[1] {
                                u[i] += white[i][k * per + j];
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
    let u = nalgebra::DMatrix::from_fn(cells.len(), frames.len(), |c, i| cells[c].u[i]);
    let null = crate::flips::MaxT::by_sign_flips(&u, 999, seed ^ 0xB145);
    let t = crate::flips::statistics(&u);
    let mut out: Vec<(f64, crate::report::Bin)> = cells
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
            if p_value > limit || n < 2.0 {
                return None;
            }
            let mean = means.iter().sum::<f64>() / n;
            let error =
                (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
            Some((
                t.abs(),
                crate::report::Bin {
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
    out.into_iter().map(|(_, bin)| bin).take(40).collect()
}
