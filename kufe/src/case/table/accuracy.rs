//! The accuracy that a case requests.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

/// How accurate the answer must be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("accuracy"))]
#[serde(deny_unknown_fields)]
pub struct AccuracyTable {
    /// Requested relative discretisation error of the peak pressure.
    pub p_max: f64,
}

impl Default for AccuracyTable {
    fn default() -> Self {
        AccuracyTable { p_max: 0.01 }
    }
}
