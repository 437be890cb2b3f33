//! Thresholds of laws outside the catalogue.

use serde::{Deserialize, Serialize};

/// Laws outside the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LawRules {
    /// Increase of the log-likelihood per number of a formula, and of a fully fitted law over the
    /// effect that it replaces. Derived: Schwarz's half of the logarithm of some thousands of rows.
    pub number: f64,
    /// Standard errors over runs within which a simpler formula is as good as a better one. Chosen.
    pub as_good: f64,
    /// The same within which another column belongs to a law's class. Derived: two, as for rivals.
    pub alike: f64,
    /// Number of smooth laws, the best first, for which formulas are tried. Chosen.
    pub tried: usize,
}

impl Default for LawRules {
    fn default() -> Self {
        Self {
            number: 4.5,
            as_good: 1.0,
            alike: 2.0,
            tried: 4,
        }
    }
}
