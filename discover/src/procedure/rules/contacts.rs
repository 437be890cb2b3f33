//! Constants of contacts that vary from run to run.

use serde::{Deserialize, Serialize};

/// Contacts with walls, each run's own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContactRules {
    /// Robust deviations of the side balance from the middle of a track's runs above which a run differs. Chosen.
    pub differs: f64,
    /// Robust deviations by which all runs together differ more at a place than along the track. Chosen.
    pub together: f64,
    /// The same at which its stretch ends. Chosen.
    pub ends: f64,
    /// Largest share of what is driven on a track beneath contacts: where more differs the model is wrong, not a wall. Chosen.
    pub most: f64,
    /// p-value of a selected effect. Chosen: what is selected must be retained by runs that did not learn it.
    pub alpha: f64,
    /// p-value of how much runs differ at a place above which pushes of single runs meet there by chance, whatever they are. Chosen.
    pub met_by_chance: f64,
    /// Shares of the way to a runner's place between which a lever is a wall's: a force further out is the runner's own. Chosen.
    pub inside: f64,
    /// Times what any single effect that is significant explains that contacts, with three numbers each, must explain. Chosen.
    pub over: f64,
    /// Deviations that a row of the side balance counts for at most where contacts are judged by their promise. Of pushes, at places that were
    /// learned and at others, both models leave all there: seventy deviations would multiply what else they differ by. Chosen.
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
