//! What accuracy a case asks for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How accurate the answer must be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AccuracyTable {
    /// Relative discretisation error asked of the peak pressure.
    #[schemars(range(min = 1e-4, max = 0.5))]
    pub p_max: f64,
}

impl Default for AccuracyTable {
    fn default() -> Self {
        AccuracyTable { p_max: 0.01 }
    }
}
