//! Report of a campaign: the results of every kind of data, and one next model.

use crate::finding::{OfKind, Report};
use crate::joint::kinds::{Joint, PRESSURES, PartFit, StepEstimates};
use crate::procedure::evidence::{Account, Description};

/// Merges the descriptions of all kinds; their separate estimates of a step go into the account.
pub fn described(
    joint: &Joint,
    estimates: &[StepEstimates],
    parts: Vec<(Description, &PartFit)>,
    account: &mut Account,
) -> Description {
    let steps = account.steps.len();
    let quantile = joint.options.rules.search.interval;
    let combined = |of: &StepEstimates| of.together.iter().map(|a| a.fitted(quantile)).collect();
    let mut all = Description {
        report: Report {
            clean: true,
            ..Report::default()
        },
        parameters: estimates.iter().map(combined).collect(),
        laws: vec![None; steps],
        ..Description::default()
    };
    all.parameters.resize(steps, Vec::new());
    let disagreements = estimates.iter().filter_map(|of| of.disagreement.clone());
    account.remarks.extend(disagreements);
    for (step, known) in account.steps.iter_mut().enumerate() {
        known.evidence = evidence(joint, estimates.get(step), &parts, step);
    }
    let several = parts.len() > 1;
    let (mut names, mut next) = (Vec::new(), Vec::new());
    for (k, (one, fit)) in parts.into_iter().enumerate() {
        let name = joint.kinds[k].name;
        names.push(one.report.data.clone());
        add_report(&mut all.report, one.report, name, several);
        for (step, law) in fit.steps.iter().zip(one.laws) {
            all.laws[*step] = all.laws[*step].take().or(law);
        }
        for (step, own) in fit.steps.iter().zip(one.parameters) {
            if all.parameters[*step].is_empty() {
                all.parameters[*step] = own;
            }
        }
        for meaning in one.effects {
            if !all.effects.iter().any(|known| known.name == meaning.name) {
                all.effects.push(meaning);
            }
        }
        let words = one.next_after_nothing;
        next.extend((!words.is_empty()).then_some(words));
        all.located |= one.located && steps == 0;
        if k == 0 {
            all.next_model = one.next_model;
        } else if name == PRESSURES {
            all.next_case = Some(one.next_model);
        }
    }
    all.report.data = names.join(", ");
    all.next_after_nothing = next.join("; ");
    for step in &account.steps {
        if !step.evidence.is_empty() && !is_written(&all, &step.effect) {
            account.remarks.push(format!(
                "{} is not in the next model, which is that of {}: those data do not determine it",
                step.effect, joint.kinds[0].name
            ));
        }
    }
    all
}

/// Adds the report of one kind of data; names of parameters and pictures state the kind if there
/// are several.
fn add_report(all: &mut Report, mut report: Report, name: &str, several: bool) {
    let base = report.base.iter_mut().map(|parameter| &mut parameter.name);
    let pictures = report.pictures.iter_mut().map(|picture| &mut picture.title);
    for shown in base.chain(pictures).filter(|_| several) {
        *shown = format!("{shown} ({name})");
    }
    let untestable = report.untestable.into_iter();
    let untestable = untestable.map(|(effect, why)| (effect, format!("{name}: {why}")));
    all.untestable.extend(untestable);
    all.training.extend(report.training);
    all.within_tolerance.extend(report.within_tolerance);
    all.session_offsets.extend(report.session_offsets);
    all.base.extend(report.base);
    all.remaining.extend(report.remaining);
    all.implausible.extend(report.implausible);
    all.bins.extend(report.bins);
    all.bins_after.extend(report.bins_after);
    all.by_run.extend(report.by_run);
    all.pictures.extend(report.pictures);
    all.next_runs.extend(report.next_runs);
    all.clean &= report.clean;
}

fn is_written(all: &Description, effect: &str) -> bool {
    let of = |text: &str| {
        text.contains(&format!("[effects.{effect}"))
            || text.contains(&format!("[effects.\"{effect}"))
    };
    of(&all.next_model) || all.next_case.as_deref().is_some_and(of)
}

/// Estimates of a step's effect by each kind that knows it.
fn evidence(
    joint: &Joint,
    estimates: Option<&StepEstimates>,
    parts: &[(Description, &PartFit)],
    step: usize,
) -> Vec<OfKind> {
    let quantile = joint.options.rules.search.interval;
    let of_kind = |(k, (description, fit)): (usize, &(Description, &PartFit))| {
        let own = fit.own_step(step)?;
        let mut by_kind = estimates.iter().flat_map(|of| &of.by_kind);
        let amounts = by_kind.find(|(kind, amounts)| *kind == k && !amounts.is_empty());
        let parameters = match amounts {
            Some((_, amounts)) => amounts.iter().map(|a| a.fitted(quantile)).collect(),
            None => description.parameters.get(own).cloned().unwrap_or_default(),
        };
        let kind = &joint.kinds[k];
        Some(OfKind {
            data: kind.name.to_owned(),
            parameters,
            agrees: estimates.is_none_or(|of| of.disagreement.is_none()),
            gap_before: kind.held_out.gap_before,
            gap_after: kind.held_out.gap_after,
            unit: kind.held_out.unit.clone(),
        })
    };
    parts.iter().enumerate().filter_map(of_kind).collect()
}
