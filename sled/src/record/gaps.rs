//! Which samples of a run are used: those of stretches in which every channel has a value and the
//! sled moves.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::columns::Columns;
use crate::series::LEAST_SAMPLES;

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

/// Which samples of a run are used, and which are missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gaps {
    /// Samples that take part, in stretches without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
    /// Rows missing in the file between its first and its last, or that hold no value.
    pub rows_missing: usize,
    /// Values that are NaN or empty in other rows, by channel.
    pub missing: BTreeMap<String, usize>,
    /// Samples at standstill between the first and the last that take part.
    pub standstill: usize,
    /// Samples in stretches too short for the filter.
    pub too_short: usize,
    /// Cut off at the start and at the end: standstill, or values missing [s].
    pub cut_s: [f64; 2],
    /// Largest distance of a row from its place on the uniform base, in steps; 0 where nothing was
    /// interpolated.
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
    /// A sample takes part where all `used` columns are finite and `v_mps`, where there is one, is
    /// above [`LEAST_SPEED`]; stretches of fewer samples than the filter needs are excluded. No
    /// piece remains where no stretch is long enough.
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
            moves = speed
                .iter()
                .map(|v| v.is_nan() || *v > LEAST_SPEED)
                .collect();
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
        let retained = first.start..last.end;
        gaps.cut_s = [retained.start, len - retained.end].map(|samples| samples as f64 * dt_s);
        gaps.standstill = moves[retained.clone()].iter().filter(|m| !**m).count();
        for column in columns.values_mut() {
            column.truncate(retained.end);
            column.drain(..retained.start);
            // A reader's room for more rows than came, of every channel of every run.
            column.shrink_to_fit();
        }
        for piece in &mut gaps.pieces {
            *piece = piece.start - retained.start..piece.end - retained.start;
        }
        gaps
    }

    /// Finite values of a column in the samples that take part, piece by piece.
    pub fn within<'a>(&'a self, column: &'a [f64]) -> impl Iterator<Item = &'a [f64]> + Clone {
        self.pieces.iter().map(|piece| &column[piece.clone()])
    }
}

/// Which samples of one run a result rests on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampleCoverage {
    /// Name of the run.
    pub run: String,
    /// What is not there.
    #[serde(flatten)]
    pub gaps: Gaps,
    /// Stretches that take part.
    pub stretches: usize,
    /// Time that takes part [s].
    pub used_s: f64,
    /// Time from the first sample to the last [s].
    pub of_s: f64,
}

/// One line on all runs with gaps; empty where there are none.
pub fn gaps_line(runs: &[SampleCoverage]) -> String {
    let Some(first) = runs.first() else {
        return String::new();
    };
    let sum = |of: fn(&SampleCoverage) -> f64| -> f64 { runs.iter().map(of).sum() };
    let mut parts = Vec::new();
    let mut count = |of: &dyn Fn(&Gaps) -> usize, what: &str| {
        let all: usize = runs.iter().map(|run| of(&run.gaps)).sum();
        if all > 0 {
            parts.push(format!("{all} {what}"));
        }
    };
    count(&|gaps| gaps.rows_missing, "rows missing");
    let columns = runs.iter().flat_map(|run| run.gaps.missing.keys());
    for column in columns.collect::<BTreeSet<&String>>() {
        let values = |gaps: &Gaps| gaps.missing.get(column).copied().unwrap_or(0);
        count(&values, &format!("values of {column} missing"));
    }
    count(&|gaps| gaps.standstill, "samples at standstill");
    let cut = sum(|run| run.gaps.cut_s.iter().sum());
    if cut > 0.0 {
        parts.push(format!("{cut:.2} s cut off at starts and ends"));
    }
    let jitter = runs.iter().map(|run| run.gaps.jitter).fold(0.0, f64::max);
    if jitter > 0.0 {
        let share = 100.0 * jitter;
        parts.push(format!(
            "rows up to {share:.0} % of a step off, brought to even steps"
        ));
    }
    let who = match runs.len() {
        1 => format!("run {}", first.run),
        many => format!("{many} runs with gaps"),
    };
    let (used, of) = (sum(|run| run.used_s), sum(|run| run.of_s));
    let parts = parts.join(", ");
    format!("{who}: {parts}; {used:.1} s of {of:.1} s take part (--strict refuses such runs)")
}

/// Share of the values that must be repeated for the usual number of rows, give or take one:
/// quantised values are not.
const EVENLY: f64 = 0.9;

/// Number of rows over which each value is repeated, where nearly all are repeated over the same
/// number, more than one.
pub fn rows_held<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<usize> {
    const FEWEST: usize = 20;
    let mut lengths = Vec::new();
    for stretch in stretches {
        let mut since: Option<usize> = None;
        for i in 1..stretch.len() {
            if stretch[i] != stretch[i - 1] {
                lengths.extend(since.map(|since| i - since));
                since = Some(i);
            }
        }
    }
    if lengths.len() < FEWEST {
        return None;
    }
    let middle = lengths.len() / 2;
    let usual = *lengths.select_nth_unstable(middle).1;
    let even = |length: &&usize| length.abs_diff(usual) <= 1;
    let even = lengths.iter().filter(even).count() as f64;
    (usual > 1 && even >= EVENLY * lengths.len() as f64).then_some(usual)
}

/// Samples of one value at the channel's end from which a sensor counts as at its stop: what
/// moves and is measured with noise stays within a converter's step for two or three.
const STRETCH: usize = 8;

/// What a channel shows of its end stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Saturation {
    /// The stop, in the channel's unit: the one at which the channel stays longest.
    pub at: f64,
    /// Samples at it in stretches of eight or more.
    pub samples: usize,
    /// The longest of these stretches, in samples.
    pub longest: usize,
    /// The sample at which that begins.
    pub begins: usize,
}

impl Saturation {
    /// Stretches of equal samples at the largest or the smallest value of a channel; none where it
    /// has only one value.
    ///
    /// The end that is nearer to zero counts only where most values differ from those before: a
    /// channel that rests there rests. Where each value is repeated over some rows, a stretch is as
    /// many times longer.
    pub fn of(values: &[f64]) -> Option<Saturation> {
        let known = || values.iter().copied().filter(|x| x.is_finite());
        let low = known().fold(f64::INFINITY, f64::min);
        let high = known().fold(f64::NEG_INFINITY, f64::max);
        if known().all(|x| x.abs() == known().next().unwrap_or(0.0).abs()) {
            return None;
        }
        let moving = values.windows(2).filter(|w| w[0] != w[1]).count();
        let rests = 2 * moving < values.len();
        let far = low.abs().max(high.abs());
        let least = STRETCH * rows_held(std::iter::once(values)).unwrap_or(1);
        let ends = [low, high].into_iter();
        ends.filter(|end| end.abs() == far || !rests)
            .filter_map(|end| at_end(values, end, least))
            .max_by_key(|found| found.longest)
    }

    /// In words, of a channel whose first sample is at `t0_s`.
    pub fn describe(&self, column: &str, t0_s: f64, dt_s: f64) -> String {
        format!(
            "column {column} stays at its extreme {} for {} samples from t = {:.3} s on: saturated?",
            self.at,
            self.longest,
            t0_s + self.begins as f64 * dt_s
        )
    }
}

fn at_end(values: &[f64], end: f64, least: usize) -> Option<Saturation> {
    let mut found = Saturation {
        at: end,
        samples: 0,
        longest: 0,
        begins: 0,
    };
    let mut begins = 0;
    for stretch in values.chunk_by(|a, b| a == b) {
        let length = stretch.len();
        if stretch[0] == end && length >= least {
            found.samples += length;
            if length > found.longest {
                (found.longest, found.begins) = (length, begins);
            }
        }
        begins += length;
    }
    (found.samples > 0).then_some(found)
}
