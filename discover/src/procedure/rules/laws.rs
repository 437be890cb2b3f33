//! Thresholds of laws outside the catalogue.

use serde::{Deserialize, Serialize};

/// Laws outside the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LawRules {
    /// Penalty on the log-likelihood per parameter of a formula, and smallest increase of the
    /// log-likelihood by a fully fitted law that replaces an effect. Derived: half the logarithm of
    /// some thousands of rows (Schwarz's criterion).
    pub number: f64,
    /// Difference of gains, in its standard errors over runs, within which a simpler formula is as
    /// good as a better one. Chosen.
    pub as_good: f64,
    /// Difference of gains, in its standard errors over runs, within which another column belongs
    /// to a law's class. Derived: two, as for rivals.
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
