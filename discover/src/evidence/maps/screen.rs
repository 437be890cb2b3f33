//! One screen of all effects: the misfit of each at its best size.

use std::collections::BTreeMap;

use kufe::case::effects::{CATALOGUE, Effect, Growth};

use crate::evidence::maps::line::LineSearch;
use crate::evidence::maps::simulate::Simulations;
use crate::evidence::maps::sized::SizedEffects;
use crate::finding::Detectable;
use crate::options::Options;
use crate::procedure::rules::Rules;

/// Line searches that are continued at a time.
const FOLLOWED: usize = 4;
/// Rounds of continued searches.
const ROUNDS: usize = 10;

/// First steps by effect's name, stored from screen to screen.
pub type Steps = BTreeMap<&'static str, f64>;

/// Searches the best size of every effect that is not in the model, in the order of the predicted
/// misfit.
///
/// Bounds on the pressure and worn sections are strongly nonlinear: the prediction of their first
/// step is unreliable, and they are continued for some rounds in any case.
pub fn screen_maps(
    simulations: &Simulations,
    active: &SizedEffects,
    steps: &mut Steps,
    options: &Options,
    progress: &dyn Fn(&str),
) -> Vec<LineSearch> {
    let chi2 = match simulations.searching(active) {
        Ok(misfit) => misfit.chi2,
        Err(_) => return Vec::new(),
    };
    let mapped = simulations.rows.iter().any(|r| r.map.is_some());
    let mut lines = Vec::new();
    for effect in CATALOGUE.iter() {
        let name = effect.info().name;
        let on = active.iter().any(|(e, _)| e.info().name == name);
        if on || !options.looks_for(name) || (!mapped && effect.search.needs_map) {
            continue;
        }
        progress(name);
        let line = LineSearch::start(simulations, active, effect, steps.get(name).copied());
        if let Some(mut line) = line {
            steps.insert(name, line.first_step());
            if effect.search.growth == Growth::Far {
                line.march(simulations, active);
            }
            lines.push(line);
        }
    }
    for round in 0..ROUNDS {
        lines.sort_by(|a, b| a.predicted_chi2().total_cmp(&b.predicted_chi2()));
        let mut moved = false;
        for (place, line) in lines.iter_mut().enumerate() {
            let near = place < FOLLOWED || round < 2;
            let promising = chi2 - line.predicted_chi2() >= options.rules.maps.least_drop && near;
            let nonlinear = is_nonlinear(line.effect) && round < 3;
            if line.settled || !(promising || nonlinear) {
                continue;
            }
            progress(line.effect.info().name);
            line.advance(simulations, active);
            moved = true;
        }
        if !moved {
            break;
        }
    }
    lines.sort_by(|a, b| a.chi2().total_cmp(&b.chi2()));
    lines
}

fn is_nonlinear(effect: &'static Effect) -> bool {
    matches!(effect.search.growth, Growth::Bent | Growth::Far)
}

/// Cosine between two effects' changes of the maps.
pub fn correlation(a: &LineSearch, b: &LineSearch) -> f64 {
    let (a, b) = (a.signature(), b.signature());
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt().max(1e-300)
}

/// Detectable sizes: those at which chi2 drops by enough with a probability of 90 %.
pub fn detectable(lines: &[LineSearch], rules: &Rules) -> Vec<Detectable> {
    lines
        .iter()
        .enumerate()
        .map(|(k, line)| {
            let like = (0..lines.len())
                .filter(|j| *j != k)
                .map(|j| (j, correlation(line, &lines[j])))
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let info = line.effect.info();
            Detectable {
                effect: info.name.to_owned(),
                parameter: line.effect.parameter().name.to_owned(),
                size: line.size_at(rules.maps.least_drop.sqrt() + rules.search.nine_in_ten),
                unit: line.effect.parameter().unit.to_owned(),
                left_after_refit: 1.0,
                most_like: like.map_or(String::new(), |(j, _)| {
                    lines[j].effect.info().name.to_owned()
                }),
                correlation: like.map_or(0.0, |(_, r)| r),
            }
        })
        .collect()
}
