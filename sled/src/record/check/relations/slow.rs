//! The slow part of a run, on which relations between channels are judged: below 1 Hz sensors' noise and places hardly count.

use std::ops::Range;

use crate::record::run::{COLUMNS, Run};

/// Corner of the Gaussian low pass [Hz].
const CORNER_HZ: f64 = 1.0;
/// Samples that are kept [Hz].
const RATE_HZ: f64 = 20.0;
/// Shortest time that is judged [s].
const LEAST_S: f64 = 5.0;

/// Channels of a run below 1 Hz, in the order of [`COLUMNS`]; `None` where one is not recorded.
#[derive(Clone, Debug)]
pub struct Slow {
    /// Time between samples [s].
    pub dt_s: f64,
    /// The channels.
    pub channels: [Option<Vec<f64>>; 10],
    /// Stretches without a gap.
    pub pieces: Vec<Range<usize>>,
}

impl Slow {
    /// The slow part of a run; `None` where less than five seconds of it are left.
    pub fn of(run: &Run) -> Option<Slow> {
        // |H(f)| = exp(-2 pi^2 f^2 sigma^2) = 2^-1/2 at the corner.
        let sigma = (0.5_f64.ln().abs() / 4.0).sqrt() / (std::f64::consts::PI * CORNER_HZ);
        let half = (4.0 * sigma / run.dt_s).ceil() as usize;
        let at = |k: usize| (k as f64 - half as f64) * run.dt_s / sigma;
        let weights: Vec<f64> = (0..=2 * half)
            .map(|k| (-0.5 * at(k).powi(2)).exp())
            .collect();
        let sum: f64 = weights.iter().sum();
        let stride = (1.0 / (RATE_HZ * run.dt_s)).round().max(1.0) as usize;
        let centres = |piece: &Range<usize>| {
            (piece.start + half..piece.end.saturating_sub(half)).step_by(stride)
        };
        let mut pieces = Vec::new();
        let mut count = 0;
        let mut kept = Vec::new();
        for piece in &run.gaps.pieces {
            let length = centres(piece).count();
            // Two samples on each side are spent on derivatives.
            if length > 8 {
                pieces.push(count..count + length);
                kept.extend(centres(piece));
                count += length;
            }
        }
        let dt_s = stride as f64 * run.dt_s;
        if (count as f64) * dt_s < LEAST_S {
            return None;
        }
        let smooth = |x: &Vec<f64>| {
            let one = |i: &usize| {
                let window = x[i - half..=i + half].iter().zip(&weights);
                window.map(|(x, w)| x * w).sum::<f64>() / sum
            };
            kept.iter().map(one).collect::<Vec<f64>>()
        };
        Some(Slow {
            dt_s,
            channels: COLUMNS.map(|name| run.columns.get(name).map(smooth)),
            pieces,
        })
    }
}
