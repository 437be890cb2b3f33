//! Constants of laws outside the catalogue.

use serde::{Deserialize, Serialize};

/// Laws outside the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LawRules {
    /// What each number of a formula must raise the rows' log-likelihood by, and a law, fitted in full, against the effect that it was
    /// selected instead of. Derived: Schwarz's half of the logarithm of some thousands of rows.
    pub number: f64,
    /// Standard errors, with everything else free, that a number of a law must be. Derived: the normal law at the largest p-value of a column
    /// outside the catalogue.
    pub number_t: f64,
    /// Standard errors over runs within which a simpler formula does as well as a better one. Chosen.
    pub as_good: f64,
    /// The same within which another column is of a law's class. Derived: two, as for rivals.
    pub alike: f64,
    /// Smooth laws, the best first, whose columns' formulas are tried. Chosen.
    pub tried: usize,
}

impl Default for LawRules {
    fn default() -> Self {
        Self {
            number: 4.5,
            number_t: 3.3,
            as_good: 1.0,
            alike: 2.0,
            tried: 4,
        }
    }
}
