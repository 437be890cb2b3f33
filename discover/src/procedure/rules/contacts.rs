//! Thresholds of contacts that vary from run to run.

use serde::{Deserialize, Serialize};

/// Contacts with walls, each run's own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContactRules {
    /// Robust deviations of the side balance from the median above which a run differs. Chosen.
    pub differs: f64,
    /// Robust deviations of all runs together at a place, relative to the track. Chosen.
    pub together: f64,
    /// The same at which its interval ends. Chosen.
    pub ends: f64,
    /// Largest share of a track during contacts: above it the model is wrong. Chosen.
    pub most: f64,
    /// p-value of a selected effect. Chosen: it must also be confirmed on held-out runs.
    pub alpha: f64,
    /// p-value of the differences of runs at a place above which they are attributed to chance
    /// pushes of single runs. Chosen.
    pub met_by_chance: f64,
    /// Range of a wall contact's lever, relative to the distance of a runner: a force further out
    /// is the runner's own. Chosen.
    pub inside: f64,
    /// Gain of contacts, which have three numbers each, over that of any single effect. Chosen.
    pub over: f64,
    /// Clipping of a row of the side balance in comparisons of contacts, in standard deviations.
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
