//! The search: fit, screen, select, add, refit, screen again; at the end, once, the held-out data.

use std::collections::HashSet;

use kufe::plot::number4;

use crate::error::Result;
use crate::finding::{Detectable, Report, Step, Verdict, fitted};
use crate::options::Options;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Evidence, Selection};
use crate::procedure::sentence::{adequacy, sentence};
use crate::procedure::verdict::{next_experiment, verdict};
use crate::procedure::verification::verify;

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    /// The report.
    pub report: Report,
    /// The model with the effects found and everything refitted, as its file's text; `None` after a
    /// quick search.
    pub next_model: Option<String>,
    /// The next case, if pressures are searched together with other data.
    pub next_case: Option<String>,
}

/// Searches data of any kind for effects that the model does not contain.
pub fn search_evidence<E: Evidence>(
    evidence: &mut E,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found> {
    let mut account = Account::default();
    progress("fitting the base model");
    let base = evidence.fit_base(&mut account)?;
    if options.quick {
        return quick_search(evidence, base, account, options, progress);
    }
    let (fit, detectable) = with_effects(evidence, &base, &mut account, options, progress)?;
    let mut last = evidence.remove_superfluous(fit, &mut account)?;
    progress("evaluating the held-out data");
    let mut refitted = last.clone();
    if !account.steps.is_empty() {
        refitted = evidence.remove_superfluous(base.clone(), &mut Account::default())?;
        last = verify(
            evidence,
            &refitted,
            last,
            &mut account,
            &options.rules.search,
        )?;
    }
    // An effect that increases the explainable misfit is wrong, even if the total misfit decreases.
    let compared = evidence.compare(&base, &last, &account.steps)?;
    if compared.are_worse() {
        account.remove_all(&compared.closed);
        last = refitted.clone();
    }
    progress("replaying the held-out data");
    let chosen = evidence.choose(&refitted, last, &mut account)?;
    last = chosen.fit;
    let opened = evidence.compare(&base, &last, &account.steps)?;
    progress("writing the report");
    let described = evidence.describe(&base, &last, &mut account)?;
    for (k, step) in account.steps.iter_mut().enumerate() {
        step.explainable_gap_closed = opened.closed.get(k).copied().unwrap_or_default();
        let parameters = described.parameters.get(k).into_iter().flatten();
        step.parameters.extend(parameters.cloned());
        step.law = described.laws.get(k).cloned().flatten();
        step.summary = described.summary(&step.effect);
    }
    let adequate = described.is_adequate();
    let verdict = verdict(&account, described.located, adequate);
    let next_experiment = next_experiment(verdict, &account, &described);
    let report = Report {
        verdict,
        explained: adequacy(&account.steps, &described.report.remaining),
        adequate,
        held_out: opened.held_out,
        written: chosen.written,
        baselines: chosen.baselines,
        withheld: chosen.withheld,
        minimum_detectable: detectable,
        next_experiment,
        seed: options.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        ..described.report
    };
    let sentence = sentence(&report, &account, &described.nothing);
    let depends = account.depends.into_iter().map(|one| one.assumption);
    Ok(Found {
        report: Report {
            sentence,
            steps: account.steps,
            remarks: distinct(account.remarks.into_iter().chain(depends)),
            ..report
        },
        next_model: Some(described.next_model),
        next_case: described.next_case,
    })
}

/// Screens and adds the selected effects until none is significant. Returns the last fit, and the
/// detectable sizes of the first screen.
fn with_effects<E: Evidence>(
    evidence: &mut E,
    base: &E::Fit,
    account: &mut Account,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<(E::Fit, Vec<Detectable>)> {
    let max_effects = options.rules.search.most_effects;
    // Several amplitudes or places of one effect belong to one step.
    let max_screens = 2 * max_effects;
    let mut fit = base.clone();
    let mut detectable = Vec::new();
    // Number of places of each step.
    let mut places: Vec<usize> = Vec::new();
    for number in 0..=max_screens {
        progress(&format!("screen {}", number + 1));
        let screen = evidence.screen(&fit, account)?;
        if detectable.is_empty() {
            detectable = screen.detectable;
        }
        let Some(selection) = screen.selection else {
            break;
        };
        let effect = &selection.candidate.effect;
        let count = account.steps.len();
        let known = account.steps.iter().position(|s| s.effect == *effect);
        if number == max_screens || known.is_none() && count == max_effects {
            if let Some(step) = known.filter(|step| places[*step] > max_effects) {
                // An effect that is significant at many places is not local; without it a global
                // effect may be significant.
                fit = evidence.without(&fit, step)?;
                account.remove_nonlocal(step, places[step]);
            } else {
                let message = format!("after {count} effects {effect} is still significant");
                account.remarks.push(message);
            }
            break;
        }
        progress(&format!("adding {}", selection.candidate.label()));
        let at = known.unwrap_or(count);
        let added = evidence.add(&fit, &selection, at)?;
        let (selection, added) = match known {
            None => evidence.exchange(&fit, (selection, added), at, account)?,
            Some(_) => (selection, added),
        };
        places.resize(count.max(at + 1), 0);
        places[at] += usize::from(added.place.is_some());
        let remark = selection.remark.clone();
        if known.is_some() {
            // Another place or amplitude of an effect belongs to the same step.
            let step = &mut account.steps[at];
            if let Some(place) = added.place.filter(|place| !place.is_empty()) {
                step.place = format!("{}; {place}", step.place);
            }
            step.gap_after = added.rms[1];
            account.remarks.extend(remark);
        } else {
            account.steps.push(step(selection, added.place, added.rms));
            account.remarks.extend(remark.filter(|_| added.is_writable));
        }
        fit = added.fit;
        if !added.is_writable {
            account.remarks.push(format!(
                "{}: the model has no such column, so that nothing was switched on",
                account.steps[at].effect
            ));
            break;
        }
    }
    Ok((fit, detectable))
}

/// A quick search: the first screen after the fit of the base. The selected effect is neither
/// fitted nor compared on held-out data.
fn quick_search<E: Evidence>(
    evidence: &mut E,
    base: E::Fit,
    mut account: Account,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found> {
    progress("screen");
    let screen = evidence.screen(&base, &mut account)?;
    let base = evidence.remove_superfluous(base, &mut account)?;
    let described = evidence.describe(&base, &base, &mut account)?;
    let adequate = described.is_adequate();
    let selected = screen.selection.as_ref();
    let summary = selected.map(|selected| described.summary(&selected.candidate.effect));
    let mut report = Report {
        adequate,
        explained: adequacy(&[], &described.report.remaining),
        minimum_detectable: screen.detectable,
        seed: options.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        ..described.report
    };
    match screen.selection {
        Some(selection) => {
            let half = options.rules.search.interval * selection.error;
            let Candidate { key, unit, .. } = &selection.candidate;
            let size = fitted(key, unit, selection.size, half);
            let mut selected = step(selection, None, [0.0; 2]);
            // Contacts differ from run to run: their mean size may be 0.
            if selected.parameters.is_empty() && size.low * size.high > 0.0 {
                selected.parameters.push(size);
            }
            selected.summary = summary.unwrap_or_default();
            report.verdict = Verdict::NotIdentifiable;
            report.next_experiment = "the search without --quick".to_owned();
            report.sentence = format!(
                "The screen selects {} (p = {}), to first order. It is neither fitted nor tested on held-out data: that is the search without --quick.",
                selected.class.join(" or "),
                number4(selected.p_value)
            );
            report.steps = vec![selected];
        }
        None => {
            report.verdict = verdict(&account, described.located, adequate);
            report.sentence = sentence(&report, &account, &described.nothing);
        }
    }
    report.remarks = distinct(account.remarks.into_iter());
    Ok(Found {
        report,
        next_model: None,
        next_case: None,
    })
}

/// Remarks without repetitions: every screen may add the same one.
fn distinct(remarks: impl Iterator<Item = String>) -> Vec<String> {
    let mut known = HashSet::new();
    remarks.filter(|text| known.insert(text.clone())).collect()
}

/// The report's entry of a selected effect; its closed share follows from the held-out data.
fn step<A>(
    selection: Selection<A>,
    place: Option<String>,
    [gap_before, gap_after]: [f64; 2],
) -> Step {
    let (channel, unit) = selection.channel;
    Step {
        effect: selection.candidate.effect,
        class: selection.class,
        channel: channel.to_owned(),
        place: place.unwrap_or(selection.place),
        p_value: selection.p_value,
        p_runs: selection.randomised.runs,
        p_sessions: selection.randomised.sessions,
        parameters: selection.parameters,
        gap_before,
        gap_after,
        unit: unit.to_owned(),
        rivals: selection.rivals,
        ..Step::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::{Interval, Verdict};
    use crate::procedure::candidate::Candidate;
    use crate::procedure::evidence::{
        Description, ExtendedFit, HeldOutResults, Randomised, Screen,
    };
    use crate::procedure::misfit_decrease::Decrease;

    /// An effect that is significant at so many places in turn; a fit is the number of effects.
    struct Places(usize);

    impl Evidence for Places {
        type Act = ();
        type Fit = usize;
        fn fit_base(&mut self, _: &mut Account) -> Result<usize> {
            Ok(0)
        }
        fn screen(&mut self, added: &usize, _: &mut Account) -> Result<Screen<()>> {
            let selection = Selection {
                candidate: Candidate {
                    effect: "asperities".to_owned(),
                    key: "excess".to_owned(),
                    unit: String::new(),
                    low: -1.0,
                    high: 1.0,
                    typical: 0.1,
                    decides: String::new(),
                    act: (),
                },
                size: 0.1,
                error: 0.01,
                class: vec!["asperities".to_owned()],
                rivals: Vec::new(),
                p_value: 1e-3,
                randomised: Randomised::default(),
                place: format!("place {added}"),
                channel: ("side", "N"),
                remark: None,
                parameters: Vec::new(),
            };
            Ok(Screen {
                selection: (*added < self.0).then_some(selection),
                detectable: Vec::new(),
            })
        }
        fn add(
            &mut self,
            added: &usize,
            _: &Selection<()>,
            _: usize,
        ) -> Result<ExtendedFit<usize>> {
            Ok(ExtendedFit {
                fit: added + 1,
                is_writable: true,
                rms: [1.0, 0.5],
                place: Some(format!("place {added}")),
            })
        }
        fn remove_superfluous(&mut self, added: usize, _: &mut Account) -> Result<usize> {
            Ok(added)
        }
        fn without(&mut self, _: &usize, _: usize) -> Result<usize> {
            Ok(0)
        }
        fn misfit_decrease(&self, _: &usize, _: &usize) -> Result<Option<Decrease>> {
            Ok(None)
        }
        fn compare(&mut self, _: &usize, _: &usize, steps: &[Step]) -> Result<HeldOutResults> {
            Ok(HeldOutResults {
                held_out: Default::default(),
                closed: vec![Interval::default(); steps.len()],
            })
        }
        fn describe(
            &mut self,
            _: &usize,
            last: &usize,
            account: &mut Account,
        ) -> Result<Description> {
            Ok(Description {
                parameters: vec![Vec::new(); account.steps.len()],
                laws: vec![None; account.steps.len()],
                next_model: last.to_string(),
                ..Description::default()
            })
        }
    }

    #[test]
    fn an_effect_significant_at_many_places_is_not_local() -> Result<()> {
        let found =
            |places: usize| search_evidence(&mut Places(places), &Options::default(), &|_| {});
        let few = found(3)?;
        assert_eq!(few.report.verdict, Verdict::Named);
        assert_eq!(few.next_model.as_deref(), Some("3"));
        let many = found(1000)?;
        assert_eq!(many.report.verdict, Verdict::NotIdentifiable);
        assert!(many.report.steps.is_empty());
        assert_eq!(many.next_model.as_deref(), Some("0"));
        let message = many.report.remarks.join(" ");
        assert!(
            message.contains("place 0; place 1") && message.contains("8 places"),
            "{message}"
        );
        Ok(())
    }
}
