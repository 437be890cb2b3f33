//! Cases made of runs and of friction experiments of the same ice and runners.

use crate::cases::answer::Case;
use crate::cases::experiments::{Cause, constant};
use crate::cases::label::Label;
use crate::cases::run_case;
use crate::world::noise::Source;

/// How a campaign of both is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Its runs.
    pub runs: run_case::Recipe,
    /// What the experiments hide, at the size that the runs hide it at.
    pub cause: Option<Cause>,
}

/// Friction in the ice house over that on the track: another ice, another finish.
const ICE_HOUSE: f64 = 1.1;

/// Builds runs and experiments with what the recipe hides in both, and their answer.
pub fn build(label: &Label, recipe: Recipe, seed: u64) -> Case {
    let mut case = run_case::build(label, recipe.runs, seed);
    let source = &mut Source::new(seed, &format!("{} experiments", label.id()));
    let base = case.answer.base.iter();
    let mu = base
        .filter(|(key, _)| key == "friction.longitudinal.mu")
        .map(|(_, mu)| ICE_HOUSE * mu)
        .next()
        .expect("runs have a coefficient of friction");
    let hidden = recipe
        .cause
        .zip(case.answer.hides.first())
        .map(|(cause, hides)| (cause, hides.size));
    let table = constant(mu, hidden, source);
    for (name, text) in [
        ("experiments.csv", table),
        (
            "campaign.toml",
            "runs = \"runs.csv\"\nexperiments = \"experiments.csv\"\nmodel = \"model.toml\"\n"
                .to_owned(),
        ),
    ] {
        case.files.push((name.to_owned(), text.into_bytes()));
    }
    case.answer.data = "campaign.toml".to_owned();
    case.answer.model = None;
    // What the runs alone cannot tell apart varies by itself in the ice house.
    for hides in &mut case.answer.hides {
        hides.class.clear();
    }
    case
}
