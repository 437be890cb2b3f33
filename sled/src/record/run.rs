//! Recorded runs, one file a run.

use std::collections::BTreeMap;

use crate::error::Error;
use crate::record::gaps::{Gaps, SampleCoverage, Saturation};
use crate::record::index::Entry;

/// One recorded run, uniform in time, in the units of its columns' names; next to a gap a column
/// may be NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its row in the index.
    pub entry: Entry,
    /// Time of the first sample [s].
    pub t0_s: f64,
    /// Time between samples [s].
    pub dt_s: f64,
    /// Every column of the file but time, by name; extra ones too.
    pub columns: BTreeMap<String, Vec<f64>>,
    /// Which samples take part, and why the others do not.
    pub gaps: Gaps,
    /// Channels that stay at an end of their range for a while.
    pub saturated: BTreeMap<String, Saturation>,
    /// What else was noticed and is no error.
    pub remarks: Vec<String>,
}

impl Run {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.columns.values().next().map_or(0, Vec::len)
    }

    /// Whether there is no sample; never so for a run that was read.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sampling rate [Hz].
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.dt_s
    }

    /// Everything that was noticed and is no error, in words.
    pub fn noticed(&self) -> Vec<String> {
        let file = self.entry.file.display();
        let remark = |(name, found): (&String, &Saturation)| {
            format!("{file}: {}", found.describe(name, self.t0_s, self.dt_s))
        };
        let remarks = self.remarks.iter().cloned();
        remarks.chain(self.saturated.iter().map(remark)).collect()
    }

    /// What of the run takes part in so many `stretches`, [s] in all.
    pub(crate) fn coverage(&self, stretches: usize, used_s: f64) -> SampleCoverage {
        SampleCoverage {
            run: self.entry.run.clone(),
            gaps: self.gaps.clone(),
            stretches,
            used_s,
            of_s: self.len() as f64 * self.dt_s,
        }
    }

    /// A column by name.
    ///
    /// # Errors
    /// [`Error::MissingColumn`] with the names there are.
    pub fn column(&self, name: &str) -> Result<&[f64], Error> {
        let column = self.columns.get(name).map(Vec::as_slice);
        let file = self.entry.file.display().to_string();
        column.ok_or_else(|| Error::missing_column(&file, name, self.columns.keys()))
    }
}
