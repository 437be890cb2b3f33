//! The search: fit, screen, select, add, refit, screen again; at the end, once, the held-out data.

use crate::error::Error;
use crate::finding::{Interval, Report, Step};
use crate::options::Options;
use crate::procedure::evidence::{Account, Evidence, Selection};
use crate::procedure::sentence::{adequacy, sentence};
use crate::procedure::verdict::{next_experiment, verdict};
use crate::procedure::verification::verify;

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    /// The report.
    pub report: Report,
    /// The model with the effects found and everything refitted, as its file's text.
    pub next_model: String,
    /// The next case, if pressures are searched together with other data.
    pub next_case: Option<String>,
}

/// Searches data of any kind for effects that the model does not contain.
pub fn search_evidence<E: Evidence>(
    evidence: &mut E,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found, Error> {
    let mut account = Account::default();
    progress("fitting the base model");
    let base = evidence.fit_base(&mut account)?;
    let rules = &options.rules.search;
    let mut fit = base.clone();
    let mut detectable = Vec::new();
    // Number of places of each step.
    let mut places: Vec<usize> = Vec::new();
    // Several amplitudes or places of one effect belong to one effect.
    let most_screens = 2 * rules.most_effects;
    for number in 0..=most_screens {
        progress(&format!("screen {}", number + 1));
        let screen = evidence.screen(&fit, &mut account)?;
        if detectable.is_empty() {
            detectable = screen.detectable;
        }
        let Some(selection) = screen.selection else {
            break;
        };
        let effect = &selection.candidate.effect;
        let known = account.steps.iter().position(|s| s.effect == *effect);
        let full = known.is_none() && account.steps.len() == rules.most_effects;
        if number == most_screens || full {
            let message = format!(
                "after {} effects {effect} is still significant",
                account.steps.len()
            );
            match known.filter(|step| places[*step] > rules.most_effects) {
                // An effect that is significant at many places is not local; without it a global
                // effect may be significant.
                Some(step) => {
                    fit = evidence.without(&fit, step)?;
                    account.remove_nonlocal(step, places[step]);
                }
                None => account.remarks.push(message),
            }
            break;
        }
        progress(&format!("adding {}", selection.candidate.label()));
        let at = known.unwrap_or(account.steps.len());
        let mut added = evidence.add(&fit, &selection, at)?;
        let mut selection = selection;
        if known.is_none() {
            (selection, added) = evidence.exchange(&fit, (selection, added), at, &account)?;
        }
        places.resize(account.steps.len().max(at + 1), 0);
        places[at] += usize::from(added.place.is_some());
        match known {
            // Another place or amplitude of an effect belongs to the same step.
            Some(known) => {
                let place = added.place.unwrap_or_default();
                let step = &mut account.steps[known];
                if !place.is_empty() {
                    step.place = format!("{}; {place}", step.place);
                }
                step.gap_after = added.gap[1];
                account.remarks.extend(selection.remark);
            }
            None => {
                let remark = selection.remark.clone();
                account.steps.push(step(selection, added.place, added.gap));
                account.remarks.extend(remark.filter(|_| added.written));
            }
        }
        fit = added.fit;
        if !added.written {
            let effect = &account.steps[at].effect;
            let message =
                format!("{effect}: the model has no such column, so that nothing was switched on");
            account.remarks.push(message);
            break;
        }
    }
    let mut last = evidence.settle(fit, &mut account)?;
    progress("evaluating the held-out data");
    let refitted = match account.steps.is_empty() {
        true => last.clone(),
        false => evidence.settle(base.clone(), &mut Account::default())?,
    };
    if !account.steps.is_empty() {
        last = verify(evidence, &refitted, last, &mut account, rules)?;
    }
    // An effect that increases the explainable misfit is wrong, even if the total misfit falls.
    let compared = evidence.open(&base, &last, &mut account)?;
    if compared.are_worse() {
        account.remove_all(&compared.closed);
        last = refitted.clone();
    }
    progress("replaying the held-out data");
    let chosen = evidence.choose(&refitted, last, &mut account)?;
    last = chosen.fit;
    let opened = evidence.open(&base, &last, &mut account)?;
    progress("writing the report");
    let described = evidence.describe(&base, &last, &mut account)?;
    for (step, closed) in account.steps.iter_mut().zip(opened.closed) {
        step.explainable_gap_closed = closed;
    }
    for (step, parameters) in account.steps.iter_mut().zip(described.parameters.clone()) {
        step.parameters.extend(parameters);
    }
    for step in &mut account.steps {
        let known = described.effects.iter().find(|e| e.name == step.effect);
        step.summary = known.map_or(String::new(), |e| e.summary.clone());
    }
    for (step, law) in account.steps.iter_mut().zip(described.laws.clone()) {
        step.law = law;
    }
    let adequate = described.remaining.iter().all(|channel| channel.is_small);
    let verdict = verdict(&account, described.located, adequate);
    let next_experiment = next_experiment(verdict, &account, &described);
    let sentence = sentence(
        verdict,
        &account,
        &opened.held_out,
        &next_experiment,
        &described.words,
        &chosen.baselines,
        adequate,
    );
    let explained = adequacy(&account.steps, &described.remaining);
    let Account {
        steps,
        mut remarks,
        depends,
        ..
    } = account;
    remarks.extend(depends.into_iter().map(|one| one.assumption));
    let report = Report {
        verdict,
        sentence,
        explained,
        adequate,
        remaining: described.remaining,
        within_tolerance: described.within_tolerance,
        steps,
        held_out: opened.held_out,
        written: chosen.written,
        baselines: chosen.baselines,
        withheld: chosen.withheld,
        implausible: described.implausible,
        minimum_detectable: detectable,
        next_experiment,
        next_runs: described.next_runs,
        base: described.base,
        bins: described.bins,
        bins_after: described.bins_after,
        by_run: described.by_run,
        clean: described.clean,
        pictures: described.pictures,
        training: described.training,
        untestable: described.untestable,
        remarks,
        gaps: Vec::new(),
        data: described.data,
        seed: options.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    Ok(Found {
        report,
        next_model: described.next_model,
        next_case: described.next_case,
    })
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
        summary: String::new(),
        channel: channel.to_owned(),
        place: place.unwrap_or(selection.place),
        law: None,
        p_value: selection.p_value,
        p_runs: selection.randomised.runs,
        p_sessions: selection.randomised.sessions,
        parameters: selection.parameters,
        gap_before,
        gap_after,
        unit: unit.to_owned(),
        explainable_gap_closed: Interval::default(),
        rivals: selection.rivals,
        contacts: Vec::new(),
        evidence: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;
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
        fn fit_base(&mut self, _: &mut Account) -> Result<usize, Error> {
            Ok(0)
        }
        fn screen(&mut self, added: &usize, _: &mut Account) -> Result<Screen<()>, Error> {
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
        ) -> Result<ExtendedFit<usize>, Error> {
            Ok(ExtendedFit {
                fit: added + 1,
                written: true,
                gap: [1.0, 0.5],
                place: Some(format!("place {added}")),
            })
        }
        fn settle(&mut self, added: usize, _: &mut Account) -> Result<usize, Error> {
            Ok(added)
        }
        fn without(&mut self, _: &usize, _: usize) -> Result<usize, Error> {
            Ok(0)
        }
        fn misfit_decrease(&self, _: &usize, _: &usize) -> Result<Option<Decrease>, Error> {
            Ok(None)
        }
        fn open(
            &mut self,
            _: &usize,
            _: &usize,
            account: &mut Account,
        ) -> Result<HeldOutResults, Error> {
            Ok(HeldOutResults {
                held_out: Default::default(),
                closed: vec![Interval::default(); account.steps.len()],
            })
        }
        fn describe(
            &mut self,
            _: &usize,
            last: &usize,
            account: &mut Account,
        ) -> Result<Description, Error> {
            Ok(Description {
                parameters: vec![Vec::new(); account.steps.len()],
                laws: vec![None; account.steps.len()],
                next_model: last.to_string(),
                ..Description::default()
            })
        }
    }

    #[test]
    fn an_effect_significant_at_many_places_is_not_local() -> Result<(), Error> {
        let found =
            |places: usize| search_evidence(&mut Places(places), &Options::default(), &|_| {});
        let few = found(3)?;
        assert_eq!(few.report.verdict, Verdict::Named);
        assert_eq!(few.next_model, "3");
        let many = found(1000)?;
        assert_eq!(many.report.verdict, Verdict::NotIdentifiable);
        assert!(many.report.steps.is_empty() && many.next_model == "0");
        let message = many.report.remarks.join(" ");
        assert!(
            message.contains("place 0; place 1") && message.contains("8 places"),
            "{message}"
        );
        Ok(())
    }
}
