//! Removal of effects that are insignificant given the others, and of laws within their errors.

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, RunFit, UnwrittenEffect};
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::finding::Step;
use crate::procedure::evidence::{Account, SUPERFLUOUS};

impl Campaign<'_> {
    /// The fit with the steps that are significant given the others, with final estimates.
    pub fn with_significant_steps(
        &self,
        mut fit: RunFit,
        account: &mut Account,
    ) -> Result<RunFit, Error> {
        loop {
            self.write(&mut fit);
            let (step, why) = match self.superfluous(&fit, &account.steps) {
                Some(step) => (step, SUPERFLUOUS),
                None => match self.of_no_size(&fit, &account.steps) {
                    Some(step) => (step, "had an interval that contains 0"),
                    None => return Ok(fit),
                },
            };
            account.remove_step(step, why);
            fit = self.without_step(&fit, step)?;
        }
    }

    /// The first step whose amplitudes are all insignificant given the others or, for a law outside
    /// the catalogue, given the full uncertainty of its numbers.
    fn superfluous(&self, fit: &RunFit, steps: &[Step]) -> Option<usize> {
        let residual_model = &fit.residual_model;
        let (already, track) = (fit.already(), CHANNEL_NAMES[3].0);
        let law = |step: &Step| step.effect.starts_with("unknown:");
        let amplitudes = &fit.estimates[self.free.len()..];
        let weak = |step: usize| {
            let least = match law(&steps[step]) {
                true => self.rules().laws.number_t,
                false => self.options.rules.search.superfluous_t,
            };
            residual_model
                .free()
                .iter()
                .zip(amplitudes)
                .filter(|((e, _), _)| *e >= already && fit.owners[*e - already] == step)
                .all(|(_, est)| (est.value / est.error.max(1e-300)).abs() < least)
        };
        (0..steps.len())
            .find(|step| fit.owners.contains(step) && steps[*step].channel != track && weak(*step))
    }

    /// The first step whose amplitudes all have intervals that contain 0.
    fn of_no_size(&self, last: &RunFit, steps: &[Step]) -> Option<usize> {
        let of_forces = |step: &usize| steps[*step].channel != CHANNEL_NAMES[3].0;
        let sizes = self.parameters(last, steps.len());
        let nothing = |step: &usize| {
            let mut sizes = sizes[*step].iter();
            let known = last.owners.contains(step) && sizes.len() > 0;
            known && sizes.all(|p| p.low <= 0.0 && p.high >= 0.0)
        };
        (0..steps.len()).filter(of_forces).find(nothing)
    }

    /// The model without the effects of a step, fitted.
    pub fn without_step(&self, fit: &RunFit, step: usize) -> Result<RunFit, Error> {
        let already = fit.already();
        let mut residual_model = fit.residual_model.clone();
        let mut place = 0;
        residual_model.effects.active.retain(|_| {
            place += 1;
            place <= already || fit.owners[place - 1 - already] != step
        });
        if let Some(contacts) = &mut residual_model.contacts {
            let own = contacts.step;
            contacts.step = own.map(|own| own - usize::from(own > step));
            if own == Some(step) {
                residual_model.contacts = None;
            }
        }
        let owners = fit
            .owners
            .iter()
            .filter(|o| **o != step)
            .map(|o| o - usize::from(*o > step))
            .collect();
        let mut next = self.fitted(&residual_model, owners)?;
        let unwritten = fit
            .unwritten
            .clone()
            .filter(|unwritten| unwritten.step != step);
        next.unwritten = unwritten.map(|unwritten| UnwrittenEffect {
            step: unwritten.step - usize::from(unwritten.step > step),
            ..unwritten
        });
        Ok(next)
    }
}
