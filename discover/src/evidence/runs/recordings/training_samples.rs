//! Training samples as recorded.

use std::ops::Range;

use kufe_sled::Run;

/// Training samples of a run.
#[derive(Clone, Debug)]
pub struct TrainingSamples<'a> {
    pub run: &'a Run,
    pub rows: Range<usize>,
}

impl TrainingSamples<'_> {
    /// A column of these samples; `None` if it is not recorded.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.run.columns.get(name)?.get(self.rows.clone())
    }

    /// Whether a column is recorded and varies.
    pub fn varies(&self, name: &str) -> bool {
        let column = self.column(name).unwrap_or_default();
        column.windows(2).any(|pair| pair[0] != pair[1])
    }
}
