//! A recorded run.

use std::collections::BTreeMap;

use crate::error::Error;
use crate::record::gaps::{Gaps, SampleCoverage, Saturation};
use crate::record::index::Entry;
use crate::series::bridged;

/// A recorded run, uniformly sampled, in the units of its columns' names. Values in gaps may be NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its row in the index.
    pub entry: Entry,
    /// Time of the first sample [s].
    pub t0_s: f64,
    /// Time between samples [s].
    pub dt_s: f64,
    /// Every column of the file except time, by name.
    pub columns: BTreeMap<String, Vec<f64>>,
    /// The samples that are used, and the reasons why others are not.
    pub gaps: Gaps,
    /// Channels that stay at an end of their range, by name.
    pub saturated: BTreeMap<String, Saturation>,
    /// Further remarks that are no errors.
    pub remarks: Vec<String>,
}

impl Run {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.columns.values().next().map_or(0, Vec::len)
    }

    /// Whether there is no sample; false for every run that was read.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sampling rate [Hz].
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.dt_s
    }

    /// Distance over the first `samples` samples by the integral of the speed, interpolated across
    /// gaps [m]; `None` without a recorded speed.
    pub(crate) fn travelled_m(&self, samples: usize) -> Option<f64> {
        let speed = bridged(self.columns.get("v_mps")?);
        Some(speed[..samples].iter().sum::<f64>() * self.dt_s)
    }

    /// All remarks, with those on saturated channels.
    pub fn noticed(&self) -> Vec<String> {
        let file = self.entry.file.display();
        let remark = |(name, found): (&String, &Saturation)| {
            format!("{file}: {}", found.describe(name, self.t0_s, self.dt_s))
        };
        let remarks = self.remarks.iter().cloned();
        remarks.chain(self.saturated.iter().map(remark)).collect()
    }

    /// The samples that a result is based on: `used_s` seconds in `stretches`.
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
    /// [`Error::MissingColumn`] with the names of the recorded columns.
    pub fn column(&self, name: &str) -> Result<&[f64], Error> {
        let column = self.columns.get(name).map(Vec::as_slice);
        let file = self.entry.file.display().to_string();
        column.ok_or_else(|| Error::missing_column(&file, name, self.columns.keys()))
    }
}
