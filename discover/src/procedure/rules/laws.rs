//! Constants of laws beyond the catalogue.

use serde::{Deserialize, Serialize};

/// Laws beyond the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LawRules {
    /// Bumps of a smooth law over a column. Chosen: what a track shows of a column is no finer.
    pub bumps: usize,
    /// Weight of a smooth law's second differences, in units of its mean information. Chosen.
    pub smoothing: f64,
    /// Parts of the runs, one of which is left out in turn where formulas are compared. Chosen.
    pub folds: usize,
    /// What each number of a formula must lower the rows' log-likelihood by in a full refit. Derived: Schwarz's half of the logarithm of
    /// some thousands of rows.
    pub number: f64,
    /// Standard errors, with everything else free, that a number of a law must be. Derived: the normal law at the largest p-value of a column beyond the
    /// catalogue.
    pub stands_t: f64,
    /// Standard errors over runs by which a law must explain more than a named effect of the catalogue to stand in its place. Chosen.
    pub beats: f64,
    /// Standard errors over runs within which a simpler formula does as well as a better one. Chosen.
    pub as_good: f64,
    /// The same within which another column is of a law's class. Derived: two, as for rivals.
    pub alike: f64,
    /// Smooth laws, the best first, whose columns' formulas are tried. Chosen.
    pub tried: usize,
    /// Effects of the catalogue, the strongest first, that a law must leave less than in full refits. Chosen.
    pub rivals: usize,
}

impl Default for LawRules {
    fn default() -> Self {
        Self {
            bumps: 7,
            smoothing: 0.02,
            folds: 5,
            number: 4.5,
            stands_t: 3.3,
            beats: 3.0,
            as_good: 1.0,
            alike: 2.0,
            tried: 4,
            rivals: 4,
        }
    }
}
