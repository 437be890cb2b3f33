//! Recorded rows that are learned from, as they were read.

use std::ops::Range;

use kufe_sled::Run;

/// Rows of a run that are learned from.
#[derive(Clone, Debug)]
pub struct Learned<'a> {
    /// The run.
    pub run: &'a Run,
    /// Its rows.
    pub rows: Range<usize>,
}

impl Learned<'_> {
    /// A column of these rows; `None` where it is not recorded.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.run.columns.get(name)?.get(self.rows.clone())
    }

    /// Whether a column is recorded and holds more than one value.
    pub fn moves(&self, name: &str) -> bool {
        let column = self.column(name).unwrap_or_default();
        column.windows(2).any(|pair| pair[0] != pair[1])
    }
}
