//! Options of a search.

use kufe_sled::Model;
use kufe_sled::effects::{CATALOGUE, Effects};

use crate::error::{Error, Result};
use crate::procedure::rules::Rules;

/// Name in [`Options::only`] of all dependences outside the catalogue.
pub const OUTSIDE_CATALOGUE: &str = "unknown";

/// Options of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Simulated runs or tables without missing effects per screen.
    pub twins: u64,
    /// Sign-flips or permutations per screen.
    pub flips: usize,
    /// Whether the longitudinal channel of runs is used.
    pub longitudinal: bool,
    /// Whether the lateral channels of runs are used.
    pub lateral: bool,
    /// Whether runs with gaps are an error; otherwise samples next to gaps are omitted.
    pub strict: bool,
    /// Names of the only effects that are searched for, or [`OUTSIDE_CATALOGUE`]; empty: all.
    pub only: Vec<String>,
    /// Whether only the base is fitted and screened.
    pub quick: bool,
    /// Thresholds of the search.
    pub rules: Rules,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            twins: 40,
            flips: 1999,
            longitudinal: true,
            lateral: true,
            strict: false,
            only: Vec::new(),
            quick: false,
            rules: Rules::default(),
        }
    }
}

impl Options {
    /// Whether an effect is searched for.
    pub fn includes(&self, effect: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|name| name == effect)
    }

    /// The remark of a report on a restricted search.
    pub(crate) fn restriction_remark(&self) -> Option<String> {
        let names = self.only.join(", ");
        let note = "were searched for, as requested; other missing effects were not";
        (!self.only.is_empty()).then(|| format!("only {names} {note}"))
    }

    /// Checks the requested names against the catalogues and the model's own effects.
    pub(crate) fn check_names(&self, model: Option<&Model>) -> Result<()> {
        let own = match model {
            Some(model) => Effects::from_tables(&model.effects)?.active,
            None => Vec::new(),
        };
        let of_runs = CATALOGUE.iter().map(|e| e.info().name);
        let of_maps = kufe::case::effects::CATALOGUE.iter().map(|e| e.info().name);
        let mut known: Vec<&str> = of_runs.chain(of_maps).chain([OUTSIDE_CATALOGUE]).collect();
        known.extend(own.iter().map(|active| active.name.as_str()));
        known.sort_unstable();
        known.dedup();
        let mut requested = self.only.iter();
        match requested.find(|name| !known.contains(&name.as_str())) {
            None => Ok(()),
            Some(name) => Err(Error::UnknownEffect {
                name: name.clone(),
                known: known.join(", "),
            }),
        }
    }
}
