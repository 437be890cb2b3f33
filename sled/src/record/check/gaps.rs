//! Which samples of a run take part: those of stretches in which every channel has a value and the sled moves.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Serialize;

use crate::record::columns::Columns;
use crate::signals::filter::LEAST_SAMPLES;

/// Least speed [m/s] at which a slip angle is taken to exist.
pub const LEAST_SPEED: f64 = 0.1;

/// What is done about samples without a value, missing rows, jitter and standstill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnGaps {
    /// They take no part, nor do the samples that a filter would mix with them.
    #[default]
    LeaveOut,
    /// The run is refused.
    Refuse,
}

/// What of a run takes part, and what is not there.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Gaps {
    /// Samples that take part, in stretches without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
    /// Rows that the file lacks between its first and its last, or that hold no value.
    pub rows_missing: usize,
    /// Values that are NaN or empty in other rows, by channel.
    pub missing: BTreeMap<String, usize>,
    /// Samples at standstill between the first and the last that take part.
    pub standstill: usize,
    /// Samples in stretches too short for the filter.
    pub too_short: usize,
    /// Cut off at the start and at the end: standstill, or values missing [s].
    pub cut_s: [f64; 2],
    /// Largest distance of a row from its place on the uniform base, in steps; 0 where nothing was interpolated.
    pub jitter: f64,
}

impl Gaps {
    /// A run of `len` samples without a gap.
    pub fn none(len: usize) -> Gaps {
        Gaps {
            pieces: std::iter::once(0..len).collect(),
            ..Gaps::default()
        }
    }

    /// Whether every sample of the file takes part as it was recorded.
    pub fn is_none(&self) -> bool {
        let counted = self.rows_missing + self.standstill + self.too_short;
        counted == 0 && self.missing.is_empty() && self.cut_s == [0.0; 2] && self.jitter == 0.0
    }

    /// Finds what takes part and cuts the columns to its first and last sample.
    ///
    /// A sample takes part where all `used` columns are finite and `v_mps`, where there is one, is above [`LEAST_SPEED`];
    /// stretches of fewer samples than the filter needs are left out. No piece is left where no stretch is long enough.
    pub fn find(columns: &mut Columns, used: &[&str], dt_s: f64) -> Gaps {
        let len = columns.values().next().map_or(0, Vec::len);
        let mut gaps = Gaps::default();
        let (mut there, mut any) = (vec![true; len], vec![false; len]);
        for name in used {
            for (i, x) in columns[*name].iter().enumerate() {
                there[i] &= x.is_finite();
                any[i] |= x.is_finite();
            }
        }
        gaps.rows_missing = any.iter().filter(|any| !**any).count();
        for name in used {
            let values = columns[*name].iter().zip(&any);
            let missing = values.filter(|(x, any)| !x.is_finite() && **any).count();
            if missing > 0 {
                gaps.missing.insert((*name).to_string(), missing);
            }
        }
        let mut moves = vec![true; len];
        if let Some(speed) = columns.get("v_mps").filter(|_| used.contains(&"v_mps")) {
            moves
                .iter_mut()
                .zip(speed)
                .for_each(|(m, v)| *m = v.is_nan() || *v > LEAST_SPEED);
        }
        let mut start = 0;
        for i in 0..=len {
            if i < len && there[i] && moves[i] {
                continue;
            }
            if i - start >= LEAST_SAMPLES {
                gaps.pieces.push(start..i);
            } else {
                gaps.too_short += i - start;
            }
            start = i + 1;
        }
        let (Some(first), Some(last)) = (gaps.pieces.first(), gaps.pieces.last()) else {
            return gaps;
        };
        let kept = first.start..last.end;
        gaps.cut_s = [kept.start, len - kept.end].map(|samples| samples as f64 * dt_s);
        gaps.standstill = moves[kept.clone()].iter().filter(|m| !**m).count();
        for column in columns.values_mut() {
            column.truncate(kept.end);
            column.drain(..kept.start);
            // A reader's room for more rows than came, of every channel of every run.
            column.shrink_to_fit();
        }
        for piece in &mut gaps.pieces {
            *piece = piece.start - kept.start..piece.end - kept.start;
        }
        gaps
    }

    /// Finite values of a column in the samples that take part, piece by piece.
    pub fn within<'a>(&'a self, column: &'a [f64]) -> impl Iterator<Item = &'a [f64]> + Clone {
        self.pieces.iter().map(|piece| &column[piece.clone()])
    }
}

/// A column without its gaps: a straight line across each, level beyond its ends; 0 where it has no value at all.
///
/// For what must be a number everywhere but of which nothing beside a gap is used, and for the way across a gap.
pub fn bridged(column: &[f64]) -> Vec<f64> {
    let mut filled = column.to_vec();
    let mut before: Option<usize> = None;
    for i in 0..column.len() {
        if !column[i].is_finite() {
            continue;
        }
        let from = before.map_or(0, |b| b + 1);
        for (k, filled) in filled.iter_mut().enumerate().take(i).skip(from) {
            *filled = match before {
                None => column[i],
                Some(b) => {
                    let share = (k - b) as f64 / (i - b) as f64;
                    column[b] + share * (column[i] - column[b])
                }
            };
        }
        before = Some(i);
    }
    let (from, end) = before.map_or((0, 0.0), |b| (b + 1, column[b]));
    filled[from..].fill(end);
    filled
}
