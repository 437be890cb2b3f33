//! Several kinds of data as one evidence.
//!
//! Each kind keeps its own base, null and held-out data. An effect that one selects is added to
//! every kind that knows it. Sizes that agree are combined and fixed in all kinds before any
//! comparison on held-out data.

use crate::error::Error;
use crate::joint::description::{PartResults, described};
use crate::joint::kinds::{Joint, JointFit, Origin, PartFit};
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Screen, Selection,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::shared_effects::Amount;

impl Evidence for Joint<'_> {
    type Act = Origin;
    type Fit = JointFit;

    fn fit_base(&mut self, account: &mut Account) -> Result<JointFit, Error> {
        let mut parts = Vec::new();
        for k in 0..self.kinds.len() {
            let mut own = Account::default();
            let free = self.kinds[k].part.fit_base(&mut own)?;
            self.add_remarks(k, own, account);
            parts.push(PartFit {
                free,
                written: free,
                steps: Vec::new(),
            });
        }
        Ok(JointFit {
            parts,
            estimates: Vec::new(),
        })
    }

    fn screen(&mut self, fit: &JointFit, account: &mut Account) -> Result<Screen<Origin>, Error> {
        let mut selections = Vec::new();
        let mut detectable = Vec::new();
        for k in 0..self.kinds.len() {
            let free = fit.parts[k].free;
            if self.kinds[k].silent == Some(free) {
                continue;
            }
            let mut own = self.own(fit, k, account);
            let screen = self.kinds[k].part.screen(&free, &mut own)?;
            self.add_remarks(k, own, account);
            detectable.extend(screen.detectable);
            match screen.selection {
                Some(selection) => selections.push((k, selection)),
                None => self.kinds[k].silent = Some(free),
            }
        }
        // The most significant first; ties go to the first kind.
        let surest = selections
            .into_iter()
            .reduce(|a, b| if b.1.p_value < a.1.p_value { b } else { a });
        let selection = match surest {
            Some((kind, selection)) => Some(self.judged(fit, kind, &selection)?),
            None => self.weak_together(fit, account),
        };
        Ok(Screen {
            selection,
            detectable,
        })
    }

    fn add(
        &mut self,
        fit: &JointFit,
        selection: &Selection<Origin>,
        step: usize,
    ) -> Result<ExtendedFit<JointFit>, Error> {
        let origin = selection.candidate.act;
        let amount = Amount::of(&selection.candidate, selection.size, selection.error);
        let common = self.is_common(&amount.effect);
        let mut next = fit.clone();
        let part = &mut next.parts[origin.kind];
        let known = part.steps.iter().position(|s| *s == step);
        let own = known.unwrap_or(part.steps.len());
        let added = self.kinds[origin.kind].part.add(
            &fit.parts[origin.kind].free,
            &selection.acting(origin.selection),
            own,
        )?;
        part.free = added.fit;
        if known.is_none() {
            part.steps.push(step);
        }
        for (k, part) in next.parts.iter_mut().enumerate() {
            if k == origin.kind || !common || part.steps.contains(&step) {
                continue;
            }
            let kind = &mut self.kinds[k].part;
            if let Some(selection) = kind.select(&part.free, &amount) {
                part.free = kind.add(&part.free, &selection, part.steps.len())?.fit;
                part.steps.push(step);
            }
        }
        Ok(ExtendedFit {
            fit: next,
            written: added.written,
            gap: added.gap,
            place: added.place,
        })
    }

    fn settle(&mut self, fit: JointFit, account: &mut Account) -> Result<JointFit, Error> {
        let mut next = fit.clone();
        for k in 0..self.kinds.len() {
            let mut own = self.own(&fit, k, account);
            let part = &mut next.parts[k];
            part.free = self.kinds[k].part.settle(part.free, &mut own)?;
            part.written = part.free;
            let own_step = |step: &usize| {
                own.steps
                    .iter()
                    .find(|s| s.effect == account.steps[*step].effect)
            };
            part.steps.retain(|step| own_step(step).is_some());
            for step in &part.steps {
                if let Some(own) = own
                    .steps
                    .iter()
                    .find(|s| s.effect == account.steps[*step].effect)
                {
                    let known = &mut account.steps[*step];
                    (known.gap_before, known.gap_after) = (own.gap_before, own.gap_after);
                }
            }
            self.add_remarks(k, own, account);
        }
        // A step that no kind contains is removed.
        for step in (0..account.steps.len()).rev() {
            if !next.parts.iter().any(|part| part.steps.contains(&step)) {
                account.steps.remove(step);
                next.remove_step(step);
            }
        }
        next.estimates.clear();
        for step in 0..account.steps.len() {
            let effect = account.steps[step].effect.clone();
            let estimates = self.estimates(&next, step, &effect)?;
            if !estimates.together.is_empty() {
                for (k, part) in next.parts.iter_mut().enumerate() {
                    if let Some(own) = part.steps.iter().position(|s| *s == step) {
                        let kind = &mut self.kinds[k].part;
                        part.written =
                            kind.with_fixed_sizes(&part.written, own, &estimates.together)?;
                    }
                }
            }
            next.estimates.push(estimates);
        }
        Ok(next)
    }

    fn without(&mut self, fit: &JointFit, step: usize) -> Result<JointFit, Error> {
        let mut next = fit.clone();
        for (k, part) in next.parts.iter_mut().enumerate() {
            if let Some(own) = part.steps.iter().position(|s| *s == step) {
                part.free = self.kinds[k].part.without(&part.free, own)?;
                part.written = part.free;
            }
        }
        next.remove_step(step);
        next.estimates.clear();
        Ok(next)
    }

    fn misfit_decrease(&self, from: &JointFit, to: &JointFit) -> Result<Option<Decrease>, Error> {
        let settled = |fit: &JointFit| {
            !fit.estimates.is_empty() || fit.parts.iter().all(|p| p.steps.is_empty())
        };
        let both = settled(from) && settled(to);
        let of = |part: &PartFit| if both { part.written } else { part.free };
        let mut sum: Option<Decrease> = None;
        for (kind, (from, to)) in self.kinds.iter().zip(from.parts.iter().zip(&to.parts)) {
            let Some(one) = kind.part.misfit_decrease(&of(from), &of(to))? else {
                continue;
            };
            sum = Some(match sum {
                None => one,
                Some(sum) => Decrease {
                    by: sum.by + one.by,
                    error: sum.error.hypot(one.error),
                    weighed: None,
                    contact_evidence: sum.contact_evidence.or(one.contact_evidence),
                    by_channel: [sum.by_channel, one.by_channel].concat(),
                    repeats: sum.repeats + one.repeats,
                },
            });
        }
        Ok(sum)
    }

    fn open(
        &mut self,
        base: &JointFit,
        last: &JointFit,
        account: &mut Account,
    ) -> Result<HeldOutResults, Error> {
        let mut closed = vec![None; account.steps.len()];
        for k in 0..self.kinds.len() {
            let mut own = self.own(last, k, account);
            let (from, to) = (base.parts[k].written, last.parts[k].written);
            let opened = self.kinds[k].part.open(&from, &to, &mut own)?;
            self.add_remarks(k, own, account);
            for (step, of_step) in last.parts[k].steps.iter().zip(opened.closed) {
                closed[*step].get_or_insert(of_step);
            }
            self.kinds[k].held_out = opened.held_out;
        }
        // The kind that the first step belongs to comes first; every kind's channels follow.
        let head = last
            .parts
            .iter()
            .position(|p| p.steps.contains(&0))
            .unwrap_or(0);
        let mut held_out = self.kinds[head].held_out.clone();
        let others = self.kinds.iter().enumerate().filter(|(k, _)| *k != head);
        let others = others.flat_map(|(_, kind)| kind.held_out.channels.clone());
        held_out.channels.extend(others);
        Ok(HeldOutResults {
            held_out,
            closed: closed.into_iter().map(Option::unwrap_or_default).collect(),
        })
    }

    fn describe(
        &mut self,
        base: &JointFit,
        last: &JointFit,
        account: &mut Account,
    ) -> Result<Description, Error> {
        let mut parts = Vec::new();
        for k in 0..self.kinds.len() {
            let mut own = self.own(last, k, account);
            let (from, to) = (base.parts[k].free, last.parts[k].written);
            let description = self.kinds[k].part.describe(&from, &to, &mut own)?;
            let steps = last.parts[k].steps.clone();
            for (step, of_part) in steps.iter().zip(&own.steps) {
                account.steps[*step].contacts.clone_from(&of_part.contacts);
            }
            self.add_remarks(k, own, account);
            parts.push(PartResults { description, steps });
        }
        Ok(described(self, &last.estimates, parts, account))
    }
}
