//! Several kinds of data as one evidence.
//!
//! Each kind keeps its own base, null and held-out data. An effect that one selects is added to
//! every kind that knows it. Sizes that agree are combined and fixed in all kinds before any
//! comparison on held-out data.

use crate::error::Result;
use crate::finding::Step;
use crate::joint::description::described;
use crate::joint::indexed::KindEvidence;
use crate::joint::kinds::{Joint, JointFit, Origin, PartFit};
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Screen, Selection,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::shared_effects::Amount;

impl Evidence for Joint<'_> {
    type Act = Origin;
    type Fit = JointFit;

    fn fit_base(&mut self, account: &mut Account) -> Result<JointFit> {
        let mut parts = Vec::new();
        for k in 0..self.kinds.len() {
            let (free, _) = self.of_kind(k, &[], account, |part, own| part.fit_base(own))?;
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

    fn screen(&mut self, fit: &JointFit, account: &mut Account) -> Result<Screen<Origin>> {
        let mut selections = Vec::new();
        let mut detectable = Vec::new();
        for (k, PartFit { free, steps, .. }) in fit.parts.iter().enumerate() {
            if self.kinds[k].silent == Some(*free) {
                continue;
            }
            let screen = |part: &mut KindEvidence, own: &mut Account| part.screen(free, own);
            let (screen, _) = self.of_kind(k, steps, account, screen)?;
            detectable.extend(screen.detectable);
            match screen.selection {
                Some(selection) => selections.push((k, selection)),
                None => self.kinds[k].silent = Some(*free),
            }
        }
        // The most significant first; ties go to the first kind.
        let surest = selections
            .into_iter()
            .reduce(|a, b| if b.1.p_value < a.1.p_value { b } else { a });
        let selection = match surest {
            Some((kind, selection)) => Some(self.with_joint_class(fit, kind, &selection)?),
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
    ) -> Result<ExtendedFit<JointFit>> {
        let Origin {
            kind: first,
            selection: place,
        } = selection.candidate.act;
        let amount = Amount::of(&selection.candidate, selection.size, selection.error);
        let common = self.is_common(&amount.effect);
        let mut next = fit.clone();
        let part = &mut next.parts[first];
        let own = part.own_step(step);
        let own_step = own.unwrap_or(part.steps.len());
        let kind = &mut self.kinds[first].part;
        let added = kind.add(&part.free, &selection.with_act(place), own_step)?;
        part.free = added.fit;
        part.steps.extend(own.is_none().then_some(step));
        for (k, part) in next.parts.iter_mut().enumerate() {
            if k == first || !common || part.steps.contains(&step) {
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
            is_writable: added.is_writable,
            rms: added.rms,
            place: added.place,
        })
    }

    fn remove_superfluous(&mut self, mut fit: JointFit, account: &mut Account) -> Result<JointFit> {
        for k in 0..self.kinds.len() {
            let part = &mut fit.parts[k];
            let free = part.free;
            let reduce =
                |kind: &mut KindEvidence, own: &mut Account| kind.remove_superfluous(free, own);
            let (reduced, own) = self.of_kind(k, &part.steps, account, reduce)?;
            (part.free, part.written) = (reduced, reduced);
            part.steps.retain(|step| {
                let known = &mut account.steps[*step];
                let own = own.iter().find(|s| s.effect == known.effect);
                if let Some(own) = own {
                    (known.gap_before, known.gap_after) = (own.gap_before, own.gap_after);
                }
                own.is_some()
            });
        }
        // A step that no kind contains is removed.
        for step in (0..account.steps.len()).rev() {
            if !fit.parts.iter().any(|part| part.steps.contains(&step)) {
                account.steps.remove(step);
                fit.remove_step(step);
            }
        }
        fit.estimates.clear();
        for (step, known) in account.steps.iter().enumerate() {
            let estimates = self.estimates(&fit, step, &known.effect);
            let sizes = &estimates.together;
            for (kind, part) in self.kinds.iter_mut().zip(&mut fit.parts) {
                if let Some(own) = part.own_step(step).filter(|_| !sizes.is_empty()) {
                    part.written = kind.part.with_fixed_sizes(&part.written, own, sizes)?;
                }
            }
            fit.estimates.push(estimates);
        }
        Ok(fit)
    }

    fn without(&mut self, fit: &JointFit, step: usize) -> Result<JointFit> {
        let mut next = fit.clone();
        for (kind, part) in self.kinds.iter_mut().zip(&mut next.parts) {
            if let Some(own) = part.own_step(step) {
                part.free = kind.part.without(&part.free, own)?;
                part.written = part.free;
            }
        }
        next.remove_step(step);
        next.estimates.clear();
        Ok(next)
    }

    fn misfit_decrease(&self, from: &JointFit, to: &JointFit) -> Result<Option<Decrease>> {
        let is_combined = |fit: &JointFit| {
            !fit.estimates.is_empty() || fit.parts.iter().all(|p| p.steps.is_empty())
        };
        let both = is_combined(from) && is_combined(to);
        let of = |part: &PartFit| if both { part.written } else { part.free };
        let mut sum: Option<Decrease> = None;
        for (kind, (from, to)) in self.kinds.iter().zip(from.parts.iter().zip(&to.parts)) {
            if let Some(one) = kind.part.misfit_decrease(&of(from), &of(to))? {
                sum = Some(match sum {
                    None => one,
                    Some(sum) => sum.with_other_data(one),
                });
            }
        }
        Ok(sum)
    }

    fn compare(
        &mut self,
        base: &JointFit,
        last: &JointFit,
        steps: &[Step],
    ) -> Result<HeldOutResults> {
        let mut closed = vec![None; steps.len()];
        let parts = base.parts.iter().zip(&last.parts);
        for (kind, (base, last)) in self.kinds.iter_mut().zip(parts) {
            let own: Vec<Step> = last.steps.iter().map(|k| steps[*k].clone()).collect();
            let compared = kind.part.compare(&base.written, &last.written, &own)?;
            for (step, of_step) in last.steps.iter().zip(compared.closed) {
                closed[*step].get_or_insert(of_step);
            }
            kind.held_out = compared.held_out;
        }
        // The kind that the first step belongs to comes first; every kind's channels follow.
        let mut parts = last.parts.iter();
        let head = parts.position(|p| p.steps.contains(&0)).unwrap_or(0);
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
    ) -> Result<Description> {
        let mut parts = Vec::new();
        for (k, (base, last)) in base.parts.iter().zip(&last.parts).enumerate() {
            let describe = |part: &mut KindEvidence, own: &mut Account| {
                part.describe(&base.free, &last.written, own)
            };
            let (description, own) = self.of_kind(k, &last.steps, account, describe)?;
            for (step, of_part) in last.steps.iter().zip(own) {
                account.steps[*step].contacts = of_part.contacts;
            }
            parts.push((description, last));
        }
        Ok(described(self, &last.estimates, parts, account))
    }
}
