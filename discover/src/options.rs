//! How a search is made.

use kufe_sled::Model;
use kufe_sled::effects::{CATALOGUE, Effects};

use crate::error::Error;
use crate::procedure::rules::Rules;

/// What is given among the effects to search for in place of all dependences that the catalogue has no name for.
pub const OUTSIDE_CATALOGUE: &str = "unknown";

/// How a search is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Simulated runs or tables in which nothing is missing, a screen.
    pub twins: u64,
    /// Sign-flips or permutations a screen.
    pub flips: usize,
    /// Whether the longitudinal channel of runs takes part.
    pub longitudinal: bool,
    /// Whether the lateral channels of runs take part.
    pub lateral: bool,
    /// Whether runs with gaps are refused rather than used without what is next to the gaps.
    pub strict: bool,
    /// The only effects that are searched for, by name, and [`OUTSIDE_CATALOGUE`] for what no name of the catalogue is; all where empty.
    pub only: Vec<String>,
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
            rules: Rules::default(),
        }
    }
}

impl Options {
    /// Whether an effect is searched for.
    pub fn looks_for(&self, effect: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|name| name == effect)
    }

    /// What a report says of effects that were not searched for.
    pub(crate) fn looked_for(&self) -> Option<String> {
        let names = self.only.join(", ");
        let note = "were searched for, as requested; what else may be missing was not";
        (!self.only.is_empty()).then(|| format!("only {names} {note}"))
    }

    /// Refuses names to search for that no effect bears, of the catalogues or of the model's own.
    pub(crate) fn refuse_unheard(&self, model: Option<&Model>) -> Result<(), Error> {
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
        match self
            .only
            .iter()
            .find(|name| !known.contains(&name.as_str()))
        {
            Some(name) => Err(Error::Unheard {
                name: name.clone(),
                known: known.join(", "),
            }),
            None => Ok(()),
        }
    }
}
