//! Series by their loggers, and what their delays are found from.

use serde::Serialize;

/// Values at times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Times [s], increasing; NaN where a sample cannot be placed.
    pub time: Vec<f64>,
    /// Values in the unit of their column.
    pub values: Vec<f64>,
}

/// A column as a logger recorded it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggerSeries {
    /// The logger.
    pub logger: String,
    /// The column.
    pub column: String,
    /// Its samples by the logger's clock.
    pub series: Series,
}

/// What one relation between channels says of a delay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Relation {
    /// The relation.
    pub relation: String,
    /// The delay [s].
    pub delay_s: f64,
    /// Its standard error [s].
    pub delay_sd_s: f64,
    /// Correlation at that delay.
    pub correlation: f64,
}
