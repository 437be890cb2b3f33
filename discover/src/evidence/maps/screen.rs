//! One screen of all effects: the misfit of each at its best size, and the selection of the best.

use std::collections::BTreeMap;

use kufe::case::effects::{CATALOGUE, Effect, Growth};

use crate::evidence::maps::line::LineSearch;
use crate::evidence::maps::simulate::{Misfit, Simulations, SizedEffects};
use crate::finding::{Detectable, Rival};
use crate::options::Options;
use crate::procedure::evidence::Selection;
use crate::procedure::rivals::{NamedEffect, RivalRule};
use crate::procedure::rules::Rules;

/// Number of line searches that are continued at a time.
const MAX_CONTINUED: usize = 4;
/// Largest number of rounds of continued searches.
const MAX_ROUNDS: usize = 10;

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
    let Ok(Misfit { chi2, .. }) = simulations.searching(active) else {
        return Vec::new();
    };
    let mapped = simulations.rows.iter().any(|r| r.map.is_some());
    let mut lines = Vec::new();
    for effect in CATALOGUE.iter() {
        let name = effect.info().name;
        let on = active.iter().any(|(e, _)| e.info().name == name);
        if on || !options.includes(name) || (!mapped && effect.search.needs_map) {
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
    for round in 0..MAX_ROUNDS {
        lines.sort_by(|a, b| a.predicted_chi2().total_cmp(&b.predicted_chi2()));
        let mut any_advanced = false;
        for (place, line) in lines.iter_mut().enumerate() {
            let growth = line.candidate.act.search.growth;
            let near = place < MAX_CONTINUED || round < 2;
            let promising = chi2 - line.predicted_chi2() >= options.rules.maps.least_drop && near;
            let nonlinear = matches!(growth, Growth::Bent | Growth::Far) && round < 3;
            if !line.converged && (promising || nonlinear) {
                progress(&line.candidate.effect);
                line.advance(simulations, active);
                any_advanced = true;
            }
        }
        if !any_advanced {
            break;
        }
    }
    lines.sort_by(|a, b| a.chi2().total_cmp(&b.chi2()));
    lines
}

/// Detectable size of each effect: the size at which chi2 decreases by enough with a probability of
/// 90 %.
pub fn detectable(lines: &[LineSearch], rules: &Rules) -> Vec<Detectable> {
    let errors = rules.maps.least_drop.sqrt() + rules.search.nine_in_ten;
    let detectable = |(k, line): (usize, &LineSearch)| {
        let others = lines.iter().enumerate().filter(|(j, _)| *j != k);
        let others = others.map(|(_, other)| (&other.candidate, line.correlation(other)));
        line.candidate.detectable(line.size_at(errors), 1.0, others)
    };
    lines.iter().enumerate().map(detectable).collect()
}

/// The first of `lines` as a selection; `before` is the sum of squares without it.
pub fn select(
    lines: &[LineSearch],
    before: f64,
    mean_square: f64,
    rule: &RivalRule,
) -> Selection<&'static Effect> {
    let best = &lines[0];
    let others = lines[1..].iter().map(|line| {
        let excess = ((line.chi2() - best.chi2()) / mean_square).max(0.0);
        let t = line.size() / line.error().max(1e-300);
        Rival {
            gain: before - line.chi2(),
            correlation: best.correlation(line),
            t_of_named_beyond: excess.sqrt(),
            in_class: true,
            ..line.candidate.rival(line.size(), t)
        }
    });
    let drop = (before - best.chi2()) / mean_square;
    let named = NamedEffect {
        effect: &best.candidate.effect,
        // The effect's t is the root of the drop of chi2.
        t: drop.sqrt(),
        gain: before - best.chi2(),
        units: 1,
    };
    let (class, rivals) = rule.class(&named, others.collect());
    let candidate = best.candidate.clone();
    Selection {
        class,
        rivals,
        // All effects were tried with free sizes: no randomisation was made.
        p_value: (lines.len() as f64 * (-0.5 * drop).exp()).clamp(1e-12, 1.0),
        ..Selection::new(candidate, best.size(), best.error(), ("", ("p", "Pa")))
    }
}

/// The rows whose misfit falls, with the one where it falls most.
pub fn place(simulations: &Simulations, before: &Misfit, after: &Misfit) -> String {
    let gains = before.by_row.iter().zip(&after.by_row).map(|(a, b)| a - b);
    let most = gains.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    match most {
        Some((row, _)) if simulations.rows.len() > 1 => {
            format!("all maps, most in {}", simulations.rows[row].name)
        }
        _ => "the map".to_owned(),
    }
}
