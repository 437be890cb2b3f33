//! The samples of a run that are used: those in which every channel has a value and the sled moves.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::columns::Columns;
use crate::series::MIN_FILTER_SAMPLES;

/// Smallest speed [m/s] at which the slip angle is defined.
pub const LEAST_SPEED: f64 = 0.1;

/// What happens to samples without a value, missing rows, jitter and standstill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnGaps {
    /// They are not used, nor are samples that a filter would mix with them.
    #[default]
    LeaveOut,
    /// The run is refused.
    Refuse,
}

/// The samples of a run that are used, and the reasons why others are not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gaps {
    /// Samples that are used, in stretches without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
    /// Rows between the first and the last of the file that are missing or have no value.
    pub rows_missing: usize,
    /// Values that are NaN or empty in other rows, by channel.
    pub missing: BTreeMap<String, usize>,
    /// Samples at standstill between the first and the last that are used.
    pub standstill: usize,
    /// Samples in stretches too short for the filter.
    pub too_short: usize,
    /// Time cut off at the start and at the end, for standstill or missing values [s].
    pub cut_s: [f64; 2],
    /// Largest distance of a row from its place on the uniform time base, in steps; 0 if nothing was
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

    /// Whether every sample of the file is used as it was recorded.
    pub fn is_none(&self) -> bool {
        let counted = self.rows_missing + self.standstill + self.too_short;
        counted == 0 && self.missing.is_empty() && self.cut_s == [0.0; 2] && self.jitter == 0.0
    }

    /// Finds the samples that are used, and cuts the columns to the first and the last of them.
    ///
    /// A sample is used if all `used` columns are finite and `v_mps`, if recorded, is above
    /// [`LEAST_SPEED`]. Stretches of fewer samples than the filter needs are excluded. `pieces` is
    /// empty if no stretch is long enough.
    pub fn find(columns: &mut Columns, used: &[&str], dt_s: f64) -> Gaps {
        let len = columns.values().next().map_or(0, Vec::len);
        let mut gaps = Gaps::default();
        let (mut is_complete, mut has_value) = (vec![true; len], vec![false; len]);
        for name in used {
            for (i, x) in columns[*name].iter().enumerate() {
                is_complete[i] &= x.is_finite();
                has_value[i] |= x.is_finite();
            }
        }
        gaps.rows_missing = has_value.iter().filter(|has_value| !**has_value).count();
        for name in used {
            let values = columns[*name].iter().zip(&has_value);
            let missing = values.filter(|(x, has_value)| !x.is_finite() && **has_value);
            let missing = missing.count();
            if missing > 0 {
                gaps.missing.insert((*name).to_string(), missing);
            }
        }
        let speed = columns.get("v_mps").filter(|_| used.contains(&"v_mps"));
        let is_at_rest = |i: usize| speed.is_some_and(|v| v[i] <= LEAST_SPEED);
        let is_at_rest: Vec<bool> = (0..len).map(is_at_rest).collect();
        let mut start = 0;
        for i in 0..=len {
            if i < len && is_complete[i] && !is_at_rest[i] {
                continue;
            }
            if i - start >= MIN_FILTER_SAMPLES {
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
        gaps.standstill = is_at_rest[retained.clone()]
            .iter()
            .filter(|rest| **rest)
            .count();
        for column in columns.values_mut() {
            column.truncate(retained.end);
            column.drain(..retained.start);
            // A reader may have reserved memory for more rows.
            column.shrink_to_fit();
        }
        for piece in &mut gaps.pieces {
            *piece = piece.start - retained.start..piece.end - retained.start;
        }
        gaps
    }

    /// The used samples of a column, piece by piece.
    pub fn within<'a>(&'a self, column: &'a [f64]) -> impl Iterator<Item = &'a [f64]> + Clone {
        self.pieces.iter().map(|piece| &column[piece.clone()])
    }
}

/// The samples of one run that a result is based on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampleCoverage {
    /// Name of the run.
    pub run: String,
    /// The samples that are not used.
    #[serde(flatten)]
    pub gaps: Gaps,
    /// Stretches that are used.
    pub stretches: usize,
    /// Time that is used [s].
    pub used_s: f64,
    /// Time from the first sample to the last [s].
    pub of_s: f64,
}

/// One line on all runs with gaps; empty if there are none.
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
    format!("{who}: {parts}; {used:.1} s of {of:.1} s are used (--strict refuses such runs)")
}

/// Median number of rows over which a value is repeated; `None` if it is one, or if fewer than 90 %
/// of the values are repeated over that number give or take one, as quantised values are.
pub fn rows_held<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<usize> {
    const MIN_VALUES: usize = 20;
    const MIN_SHARE: f64 = 0.9;
    let mut lengths = Vec::new();
    for stretch in stretches {
        let mut last_change: Option<usize> = None;
        for i in 1..stretch.len() {
            if stretch[i] != stretch[i - 1] {
                lengths.extend(last_change.map(|last| i - last));
                last_change = Some(i);
            }
        }
    }
    if lengths.len() < MIN_VALUES {
        return None;
    }
    let middle = lengths.len() / 2;
    let median = *lengths.select_nth_unstable(middle).1;
    let near = |length: &&usize| length.abs_diff(median) <= 1;
    let near = lengths.iter().filter(near).count() as f64;
    (median > 1 && near >= MIN_SHARE * lengths.len() as f64).then_some(median)
}

/// Fewest equal samples at an end of a channel's range that show an end stop. A noisy signal stays
/// within a converter's step for two or three.
const MIN_STOP_SAMPLES: usize = 8;

/// Samples of a channel at an end stop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Saturation {
    /// Value of the end stop at which the channel stays longest, in its unit.
    pub at: f64,
    /// Samples at it in stretches of eight or more.
    pub samples: usize,
    /// Length of the longest of these stretches [samples].
    pub longest: usize,
    /// First sample of the longest stretch.
    pub begins: usize,
}

impl Saturation {
    /// Stretches of equal samples at the largest or the smallest value of a channel; `None` if it
    /// has only one magnitude.
    ///
    /// The end nearer to zero counts only if most values differ from those before: otherwise the
    /// channel may be at rest there. If each value is repeated over some rows, a stretch must be as
    /// many times longer.
    pub fn of(values: &[f64]) -> Option<Saturation> {
        let known = || values.iter().copied().filter(|x| x.is_finite());
        let low = known().fold(f64::INFINITY, f64::min);
        let high = known().fold(f64::NEG_INFINITY, f64::max);
        if known().all(|x| x.abs() == known().next().unwrap_or(0.0).abs()) {
            return None;
        }
        let changes = values.windows(2).filter(|w| w[0] != w[1]).count();
        let may_rest = 2 * changes < values.len();
        let farther = low.abs().max(high.abs());
        let min_length = MIN_STOP_SAMPLES * rows_held(std::iter::once(values)).unwrap_or(1);
        let ends = [low, high].into_iter();
        ends.filter(|end| end.abs() == farther || !may_rest)
            .filter_map(|end| at_end(values, end, min_length))
            .max_by_key(|found| found.longest)
    }

    /// The saturation in words, for a channel whose first sample is at `t0_s`.
    pub fn describe(&self, column: &str, t0_s: f64, dt_s: f64) -> String {
        format!(
            "column {column} stays at its extreme {} for {} samples from t = {:.3} s on: saturated?",
            self.at,
            self.longest,
            t0_s + self.begins as f64 * dt_s
        )
    }
}

/// Stretches of `min_length` samples or more with the value `end`.
fn at_end(values: &[f64], end: f64, min_length: usize) -> Option<Saturation> {
    let mut found = Saturation {
        at: end,
        samples: 0,
        longest: 0,
        begins: 0,
    };
    let mut begins = 0;
    for stretch in values.chunk_by(|a, b| a == b) {
        let length = stretch.len();
        if stretch[0] == end && length >= min_length {
            found.samples += length;
            if length > found.longest {
                (found.longest, found.begins) = (length, begins);
            }
        }
        begins += length;
    }
    (found.samples > 0).then_some(found)
}
