//! Removal of effects that are insignificant given the others.

use crate::error::Result;
use crate::evidence::runs::campaign::{Campaign, RunFit, UnwrittenEffect};
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, TRACK};
use crate::finding::Step;
use crate::procedure::evidence::{Account, NO_SIZE};

impl Campaign<'_> {
    /// The fit without the steps that are insignificant given the others, with final estimates.
    pub fn with_significant_steps(&self, mut fit: RunFit, account: &mut Account) -> Result<RunFit> {
        loop {
            self.set_final_estimates(&mut fit);
            let Some(step) = self.insignificant_step(&fit, &account.steps) else {
                return Ok(fit);
            };
            account.remove_step(step, NO_SIZE);
            fit = self.without_step(&fit, step)?;
        }
    }

    /// The first step whose amplitudes all have intervals that contain 0.
    pub fn insignificant_step(&self, last: &RunFit, steps: &[Step]) -> Option<usize> {
        let of_forces = |step: &usize| steps[*step].channel != CHANNEL_NAMES[TRACK].0;
        let sizes = self.parameters(last, steps.len());
        let is_insignificant = |step: &usize| {
            let mut sizes = sizes[*step].iter();
            let known = last.owners.contains(step) && sizes.len() > 0;
            known && sizes.all(|p| p.low <= 0.0 && p.high >= 0.0)
        };
        (0..steps.len()).filter(of_forces).find(is_insignificant)
    }

    /// The model without the effects of a step, fitted.
    pub fn without_step(&self, fit: &RunFit, step: usize) -> Result<RunFit> {
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
        let owners = fit.owners.iter().filter(|o| **o != step);
        let owners = owners.map(|o| o - usize::from(*o > step)).collect();
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
