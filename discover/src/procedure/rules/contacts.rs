//! Thresholds of contacts that vary from run to run.

use serde::{Deserialize, Serialize};

/// Contacts with walls, each run's own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContactRules {
    /// Deviation of a run's lateral residual from the median over runs, in robust standard
    /// deviations, above which the run differs. Chosen.
    pub differs: f64,
    /// Deviation of the mean square over all runs at a place from the track's median, in robust
    /// standard deviations, above which the runs differ. Chosen.
    pub together: f64,
    /// Deviation of a run, in robust standard deviations, below which the interval of a place ends.
    /// Chosen.
    pub ends: f64,
    /// Largest share of a track at which runs differ: above it the model is wrong. Chosen.
    pub most: f64,
    /// Largest p-value of selected contacts. Chosen: it must also be confirmed on held-out runs.
    pub alpha: f64,
    /// p-value of the differences between runs at a place above which they are attributed to chance
    /// pushes of single runs. Chosen.
    pub met_by_chance: f64,
    /// Largest ratio of a wall contact's lever to the distance of the runner on that side: a force
    /// further out is a force of the runner. Chosen.
    pub inside: f64,
    /// Ratio of the gain of contacts, which have three numbers each, to the gain of any single
    /// effect, above which contacts are selected. Chosen.
    pub over: f64,
    /// Clipping of a row of the lateral balance in comparisons of contacts, in standard deviations.
    /// Other pushes remain in the residuals of both models: seventy deviations would multiply any
    /// other difference. Chosen.
    pub most_of_a_row: f64,
}

impl Default for ContactRules {
    fn default() -> Self {
        Self {
            differs: 8.0,
            together: 3.25,
            ends: 4.0,
            most: 0.1,
            alpha: 0.02,
            met_by_chance: 0.1,
            inside: 0.75,
            over: 2.0,
            most_of_a_row: 6.0,
        }
    }
}
