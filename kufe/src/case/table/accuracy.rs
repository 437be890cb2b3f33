//! What accuracy a case asks for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

/// How accurate the answer must be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("accuracy"))]
#[serde(deny_unknown_fields)]
pub struct AccuracyTable {
    /// Relative discretisation error asked of the peak pressure.
    pub p_max: f64,
}

impl Default for AccuracyTable {
    fn default() -> Self {
        AccuracyTable { p_max: 0.01 }
    }
}
