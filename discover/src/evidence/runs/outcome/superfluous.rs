//! Which claims the others have made superfluous, and which laws do not stand out of their own error.

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, RunFit, Told};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::evidence::runs::model::whiten::Whitener;
use crate::finding::report::Step;

impl Campaign<'_> {
    /// The first step whose every amplitude has become weak: beside the others, or, of a law beyond the catalogue, beside what its
    /// numbers are known by with everything else free.
    pub fn superfluous(&self, fit: &RunFit, steps: &[Step]) -> Option<usize> {
        let residual_model = &fit.residual_model.hold(false);
        let (already, track) = (fit.already(), CHANNEL_NAMES[3].0);
        let law = |step: &Step| step.effect.starts_with("unknown:");
        if steps.len() < 2 && !steps.iter().any(law) {
            return None;
        }
        let whitener = Whitener::estimate(&residuals(residual_model, &self.training), self.used);
        let (estimates, _) = self.estimates(residual_model, &whitener);
        let amplitudes = &estimates[self.free.len()..];
        let weak = |step: usize| {
            let least = match law(&steps[step]) {
                true => self.rules().laws.stands_t,
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

    /// The model without the effects of a step, fitted.
    ///
    /// # Errors
    /// Those of the fit.
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
        let told = fit.told.clone().filter(|told| told.step != step);
        next.told = told.map(|told| Told {
            step: told.step - usize::from(told.step > step),
            ..told
        });
        Ok(next)
    }
}
