//! Report of a campaign: the results of every kind of data, and one next model.

use crate::finding::{Fitted, OfKind};
use crate::joint::kinds::{Joint, PRESSURES, StepEstimates};
use crate::procedure::evidence::{Account, Description, Words};

/// Results of one kind of data.
pub struct PartResults {
    pub description: Description,
    /// The campaign's step of each of its own.
    pub steps: Vec<usize>,
}

/// Merges the descriptions of all kinds; their separate estimates of a step go into the account.
pub fn described(
    joint: &Joint,
    estimates: &[StepEstimates],
    parts: Vec<PartResults>,
    account: &mut Account,
) -> Description {
    let steps = account.steps.len();
    let mut all = Description {
        parameters: estimates
            .iter()
            .map(|estimates| joint.combined(estimates))
            .collect(),
        laws: vec![None; steps],
        clean: true,
        words: Words {
            next_after_nothing: next_after_nothing(&parts),
            ..Words::default()
        },
        ..Description::default()
    };
    all.parameters.resize(steps, Vec::new());
    account.remarks.extend(
        estimates
            .iter()
            .filter_map(|estimates| estimates.disagreement.clone()),
    );
    for (step, known) in account.steps.iter_mut().enumerate() {
        known.evidence = evidence(joint, estimates.get(step), &parts, step);
    }
    let several = parts.len() > 1;
    let mut names = Vec::new();
    for (k, part) in parts.into_iter().enumerate() {
        let mut one = part.description;
        let name = joint.kinds[k].name;
        for (step, law) in part.steps.iter().zip(one.laws) {
            all.laws[*step] = all.laws[*step].take().or(law);
        }
        for (step, own) in part.steps.iter().zip(one.parameters) {
            if all.parameters[*step].is_empty() {
                all.parameters[*step] = own;
            }
        }
        // Bases of two kinds may have parameters of the same name.
        for parameter in &mut one.base {
            if several {
                parameter.name = format!("{} ({name})", parameter.name);
            }
        }
        for picture in &mut one.pictures {
            if several {
                picture.title = format!("{} ({name})", picture.title);
            }
        }
        let untestable = one.untestable.into_iter();
        all.untestable
            .extend(untestable.map(|(effect, why)| (effect, format!("{name}: {why}"))));
        for meaning in one.effects {
            if !all.effects.iter().any(|known| known.name == meaning.name) {
                all.effects.push(meaning);
            }
        }
        names.push(one.data);
        all.training.extend(one.training);
        all.within_tolerance.extend(one.within_tolerance);
        all.base.extend(one.base);
        all.remaining.extend(one.remaining);
        all.implausible.extend(one.implausible);
        all.bins.extend(one.bins);
        all.bins_after.extend(one.bins_after);
        all.by_run.extend(one.by_run);
        all.pictures.extend(one.pictures);
        all.next_runs.extend(one.next_runs);
        all.clean &= one.clean;
        all.located |= one.located && steps == 0;
        if k == 0 {
            all.next_model = one.next_model;
        } else if name == PRESSURES {
            all.next_case = Some(one.next_model);
        }
    }
    all.data = names.join(", ");
    for step in &account.steps {
        let unwritten = !step.evidence.is_empty() && !is_written(&all, &step.effect);
        if unwritten {
            account.remarks.push(format!(
                "{} is not in the next model, which is that of {}: those data do not determine it",
                step.effect, joint.kinds[0].name
            ));
        }
    }
    all
}

fn is_written(all: &Description, effect: &str) -> bool {
    let of = |text: &str| {
        text.contains(&format!("[effects.{effect}"))
            || text.contains(&format!("[effects.\"{effect}"))
    };
    of(&all.next_model) || all.next_case.as_deref().is_some_and(of)
}

fn next_after_nothing(parts: &[PartResults]) -> String {
    let each: Vec<&str> = parts
        .iter()
        .map(|part| part.description.words.next_after_nothing.as_str())
        .filter(|text| !text.is_empty())
        .collect();
    each.join("; ")
}

/// Estimates of a step's effect by each kind that knows it.
fn evidence(
    joint: &Joint,
    estimates: Option<&StepEstimates>,
    parts: &[PartResults],
    step: usize,
) -> Vec<OfKind> {
    let quantile = joint.options.rules.search.interval;
    let mut each = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let Some(own) = part.steps.iter().position(|s| *s == step) else {
            continue;
        };
        let amounts = estimates
            .and_then(|estimates| estimates.by_kind.iter().find(|(kind, _)| *kind == k))
            .map(|(_, amounts)| amounts.iter().map(|a| a.fitted(quantile)).collect());
        let described = part.description.parameters.get(own).cloned();
        let parameters: Vec<Fitted> = amounts
            .filter(|amounts: &Vec<Fitted>| !amounts.is_empty())
            .or(described)
            .unwrap_or_default();
        let held_out = &joint.kinds[k].held_out;
        each.push(OfKind {
            data: joint.kinds[k].name.to_owned(),
            parameters,
            agrees: estimates.is_none_or(|estimates| estimates.disagreement.is_none()),
            gap_before: held_out.gap_before,
            gap_after: held_out.gap_after,
            unit: held_out.unit.clone(),
        });
    }
    each
}
