//! Which selected effects the others have made superfluous, which laws do not exceed their own error, and in whose place one effect does: a sled
//! heavier than its model feels less drag, and turns more easily, by the share that its forces are said to be smaller.

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, RunFit, Unwritten, gap_of};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::{Effort, residuals};
use crate::evidence::runs::laws::sums::{difference, total};
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ResidualModel, TRACK};
use crate::evidence::runs::model::whiten::Whitener;
use crate::finding::Step;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, SUPERFLUOUS};

/// A candidate by itself: its model, and what that leaves of each run.
struct Alone {
    model: ResidualModel,
    misfit: Vec<f64>,
}

/// One effect in place of one step or two.
struct OneInstead {
    /// The step whose class it is of, and the other one that it makes superfluous; the same where there is none.
    steps: [usize; 2],
    /// Its name, and those that leave no more.
    class: Vec<String>,
    /// The model with it, without them.
    model: ResidualModel,
    /// The steps of the other effects, as they are counted then.
    owners: Vec<usize>,
}

impl Campaign<'_> {
    /// The fit with the steps that are each significant given the others, as it would be written.
    ///
    /// # Errors
    /// Those of the fits.
    pub fn with_what_lasts(&self, mut fit: RunFit, account: &mut Account) -> Result<RunFit, Error> {
        loop {
            while let Some(step) = self.superfluous(&fit, &account.steps) {
                account.leave_out(step, SUPERFLUOUS);
                fit = self.without_step(&fit, step)?;
            }
            let mut last = self.with_one_instead(fit, account)?;
            self.write(&mut last)?;
            let Some(step) = self.of_no_size(&last, &account.steps) else {
                return Ok(last);
            };
            account.leave_out(step, "had an interval that holds 0");
            fit = self.without_step(&last, step)?;
        }
    }

    /// The first step whose every amplitude has become weak: given the others, or, of a law outside the catalogue, given what its
    /// numbers are known by with everything else free.
    fn superfluous(&self, fit: &RunFit, steps: &[Step]) -> Option<usize> {
        let residual_model = &fit.residual_model.hold(false);
        let (already, track) = (fit.already(), CHANNEL_NAMES[3].0);
        let law = |step: &Step| step.effect.starts_with("unknown:");
        if steps.is_empty() {
            return None;
        }
        let whitener = Whitener::estimate(&residuals(residual_model, &self.training), self.used);
        let (estimates, _) = self.estimates(residual_model, &whitener);
        let amplitudes = &estimates[self.free.len()..];
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

    /// The first step of which every amplitude could as well be 0, by the intervals that are reported of it.
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

    /// The fit with one effect wherever it does in place of a step, or of two.
    ///
    /// # Errors
    /// Those of the fit.
    fn with_one_instead(&self, mut fit: RunFit, account: &mut Account) -> Result<RunFit, Error> {
        while let Some(one) = self.one_instead(&fit, &account.steps)? {
            let [first, other] = one.steps;
            let mut step = account.steps[first].clone();
            let why = match first == other {
                true => "leaves less, fitted in full: it is named instead".to_owned(),
                false => format!(
                    "alone leaves no more than both it and {}",
                    account.steps[other].effect
                ),
            };
            let effect = one.class[0].clone();
            let message = format!("{effect} of the class of {} {why}", step.effect);
            account.remarks.push(message);
            (step.effect, step.class) = (effect, one.class);
            account.steps.remove(first.max(other));
            if first != other {
                account.steps.remove(first.min(other));
            }
            let owners = one.owners.into_iter().chain([account.steps.len()]);
            fit = self.installed(&self.least_squares(&one.model, owners.collect())?)?;
            let mut channels = CHANNEL_NAMES.iter();
            let channel = channels.position(|(name, _)| *name == step.channel);
            step.gap_after = gap_of(&fit.residual_model, &self.training, channel.unwrap_or(1));
            account.steps.push(step);
        }
        Ok(fit)
    }

    /// Steps in whose place one effect does: of the class of a step one that leaves clearly less than it, or no more than it and another step
    /// together, in full refits.
    fn one_instead(&self, fit: &RunFit, steps: &[Step]) -> Result<Option<OneInstead>, Error> {
        let track = CHANNEL_NAMES[TRACK].0;
        let regular = &self.candidates.regular;
        let known =
            |step: &Step| step.channel != track && regular.iter().any(|c| c.effect == step.effect);
        let alike = self.rules().laws.alike;
        for (first, step) in steps.iter().enumerate().filter(|(_, step)| known(step)) {
            let of_class = |c: &&Candidate<Amplitude>| {
                let mut others = steps.iter().filter(|other| other.effect != step.effect);
                step.class.contains(&c.effect) && others.all(|other| other.effect != c.effect)
            };
            let class: Vec<&Candidate<Amplitude>> = regular.iter().filter(of_class).collect();
            if class.iter().all(|c| c.effect == step.effect) {
                continue;
            }
            let Some(as_it_is) = self.left_by(&fit.residual_model) else {
                continue;
            };
            let others = steps.iter().enumerate().filter(|(_, step)| known(step));
            for other in others.map(|(other, _)| other) {
                let mut without = self.without_step(fit, other.max(first))?;
                if other != first {
                    without = self.without_step(&without, other.min(first))?;
                }
                // What the installation is off by with them represents a part of the one.
                let bare = ResidualModel {
                    installation: Installation::default(),
                    ..without.residual_model
                };
                let each = class
                    .iter()
                    .filter_map(|c| Some((c.effect.as_str(), self.alone(&bare, c)?)));
                let mut each: Vec<(&str, Alone)> = each.collect();
                each.sort_by(|(_, a), (_, b)| total(&a.misfit).total_cmp(&total(&b.misfit)));
                let Some(best) = each.iter().position(|(name, _)| *name != step.effect) else {
                    continue;
                };
                let (effect, one) = each.remove(best);
                let [more, error] = difference(&one.misfit, &as_it_is);
                let better = match other == first {
                    true => more < -alike * error,
                    false => more <= alike * error,
                };
                if better {
                    let as_good = each.into_iter().filter(|(_, rival)| {
                        let [more, error] = difference(&rival.misfit, &one.misfit);
                        more <= alike * error
                    });
                    let mut class = vec![effect.to_owned()];
                    for (rival, _) in as_good {
                        if !class.iter().any(|known| known == rival) {
                            class.push(rival.to_owned());
                        }
                    }
                    // What the step's own effect does as well, fitted in the same way, is no reason to call it otherwise.
                    if other == first && class.contains(&step.effect) {
                        continue;
                    }
                    return Ok(Some(OneInstead {
                        steps: [first, other],
                        class,
                        model: one.model,
                        owners: without.owners,
                    }));
                }
            }
        }
        Ok(None)
    }

    /// What a model leaves of each run, fitted, what its installation is off by found, and fitted once more with that: found to first order
    /// it applies where base and effects are bent.
    fn left_by(&self, model: &ResidualModel) -> Option<Vec<f64>> {
        let refit = self.beside_either(model, Effort::COMPARED, f64::INFINITY)?;
        let anew = self.installed_anew(&refit)?;
        let refitted = self.beside_either(&anew.model, Effort::COMPARED, f64::INFINITY)?;
        Some(self.misfit_by_run(&refitted))
    }

    /// A candidate fitted to a model without an installation, of either sign.
    fn alone(&self, bare: &ResidualModel, candidate: &Candidate<Amplitude>) -> Option<Alone> {
        let of_sign = |sign: f64| {
            let from = 0.01 * sign * candidate.typical;
            self.refitted(bare, candidate, from, Effort::COMPARED)
        };
        let tried = [1.0, -1.0].into_iter().filter_map(of_sign);
        let one = tried.min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        Some(Alone {
            misfit: self.left_by(&one.model)?,
            model: one.model,
        })
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
        let unwritten = fit
            .unwritten
            .clone()
            .filter(|unwritten| unwritten.step != step);
        next.unwritten = unwritten.map(|unwritten| Unwritten {
            step: unwritten.step - usize::from(unwritten.step > step),
            ..unwritten
        });
        Ok(next)
    }
}
