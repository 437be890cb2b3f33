//! Choice of the model that is written, by comparison with the given model on other runs than those
//! it was fitted to.
//!
//! Every model is read back from its text. Two comparisons are made:
//!
//! - the misfit of each balance on the held-out runs, in pieces of a run, with the
//!   installation errors of these runs;
//! - the replay: a simulation from each run's start with its steering, and the differences of time,
//!   speed and yaw rate over distance. Training runs are replayed with the estimates without their
//!   session (the jackknife).
//!
//! A quantity is worse if its mean square grows by more than its scatter over the pieces or
//! sessions, by more than a stated share, and for a replay by more than the variance of the
//! sensor's noise. The first model without a worse quantity is written, of: base and effects, the
//! refitted base, the model as given. Friction is that of the replays
//! ([`replays`](crate::evidence::runs::outcome::replays)); grip is refitted if the replays are then
//! better than with the grip as given.

use std::cmp::Ordering;

use rayon::prelude::*;

use crate::error::Result;
use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::contacts::run_contacts::without_pushes;
use crate::evidence::runs::fit::row_noise::expected;
use crate::evidence::runs::model::residual_model::{
    BALANCES, BASE_NAMES, CHANNEL_NAMES, ResidualModel,
};
use crate::evidence::runs::outcome::conclude::base_value;
use crate::evidence::runs::outcome::held_out_misfit::with_whole_side;
use crate::evidence::runs::outcome::replays::Squares;
use crate::finding::{Baseline, Fitted, ModelKind, Rival, Withheld};
use crate::procedure::evidence::{Account, Choice, Evidence, NO_SIZE};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::rules::SearchRules;
use crate::procedure::shared_effects::{Amount, SharesEffects};

/// Rows of a piece of a run for comparisons of misfits: four seconds, beyond which residuals are
/// uncorrelated.
pub const PIECE_ROWS: usize = 40;

/// Mean squares by which models are compared; empty for a model that cannot be simulated.
#[derive(Default)]
struct Performance {
    /// Residuals of the balances on the held-out runs.
    channels: Vec<Squares>,
    /// Differences of the replays, one piece per session.
    replays: Vec<Squares>,
    /// Indices of the replayed runs.
    replayed: Vec<usize>,
}

impl Performance {
    fn all(&self) -> impl Iterator<Item = &Squares> {
        self.channels.iter().chain(&self.replays)
    }

    /// Sum of the logarithms of the mean squares of the replays, or of the channels if nothing was
    /// replayed.
    fn misfit(&self) -> f64 {
        let squares = if self.replays.is_empty() {
            &self.channels
        } else {
            &self.replays
        };
        squares.iter().map(|squares| squares.mean().ln()).sum()
    }

    /// The quantities that are worse than with `other`, in words.
    fn worse_than(&self, other: &Self, rules: &SearchRules) -> Vec<String> {
        let describe = |(after, before): (&Squares, &Squares)| {
            is_larger(after, before, rules).then(|| {
                let [a, b] = [after, before].map(|s| kufe::plot::quantity(s.rms(), s.unit));
                format!("{} {a}, as given {b}", after.name)
            })
        };
        self.all().zip(other.all()).filter_map(describe).collect()
    }
}

/// Whether the mean square of `after` exceeds that of `before` by more than scatter, noise and the
/// stated share.
///
/// With fewer than three pieces the scatter is the standard deviation of a sum of n squares of
/// normal variables: the expected sum times sqrt(2 / n).
fn is_larger(after: &Squares, before: &Squares, rules: &SearchRules) -> bool {
    let both = after.pieces.iter().zip(&before.pieces);
    let decreases: Vec<f64> = both.map(|(a, b)| b[0] - a[0]).collect();
    let Some(decrease) = Decrease::over(&decreases) else {
        return false;
    };
    let n = decreases.len() as f64;
    let sum: f64 = before.pieces.iter().map(|p| p[0]).sum();
    let error = if decreases.len() < 3 {
        decrease.error.max(sum * (2.0 / n).sqrt())
    } else {
        decrease.error
    };
    let share = (1.0 + rules.material).powi(2);
    -decrease.by > rules.interval * error && after.mean() > share * before.mean() + before.noise
}

/// A model that may be written, and the reasons against writing it.
struct Trial {
    fit: RunFit,
    performance: Option<Performance>,
    reasons: Vec<String>,
}

impl Trial {
    /// Sum of the logarithms of the mean squares; infinite for a model that cannot be simulated.
    fn misfit(&self) -> f64 {
        let misfit = self.performance.as_ref().map(Performance::misfit);
        misfit.unwrap_or(f64::INFINITY)
    }

    /// Orders models without a reason against them first, then by misfit.
    fn cmp(&self, other: &Self) -> Ordering {
        let [own, its] = [self, other].map(|trial| !trial.reasons.is_empty());
        let by_misfit = || self.misfit().total_cmp(&other.misfit());
        own.cmp(&its).then_with(by_misfit)
    }
}

/// The models with effects, without the steps that make other runs worse.
struct WithEffects {
    /// The last fit, before the choice of its base.
    last: RunFit,
    /// The model that may be written; `None` if all are worse than the model as given.
    accepted: Option<RunFit>,
    /// Of the accepted model, or of the last one that was worse; `None` without effects.
    performance: Option<Performance>,
}

impl Campaign<'_> {
    /// The model to write: one of these two fits or the model as given.
    ///
    /// # Errors
    /// [`Error::BaseFit`](crate::error::Error::BaseFit) if a fit with one effect less has a residual that is not finite.
    pub fn chosen(
        &mut self,
        refitted: &RunFit,
        last: RunFit,
        account: &mut Account,
    ) -> Result<Choice<RunFit>> {
        let as_given = self.as_given(refitted);
        let given = self.performance(&as_given, None).unwrap_or_else(|reason| {
            account.remarks.push(format!(
                "the model as given cannot be compared on other runs: {reason}"
            ));
            Performance::default()
        });
        let mut withheld = Vec::new();
        let with_effects = self.without_worse_steps(last, &given, &mut withheld, account)?;
        if let WithEffects {
            accepted: Some(fit),
            performance: Some(own),
            ..
        } = &with_effects
        {
            self.join_better_rivals((refitted, fit), (own, &given), account)?;
        }
        let mut base = self.trial(refitted, &given);
        if base.performance.is_some() && base.misfit() > given.misfit() {
            let reason = "other runs are not replayed better".to_owned();
            base.reasons.push(reason);
        }
        let refusal = base.reasons.join("; ");
        let (mut written, mut fit) = match with_effects.accepted {
            Some(fit) => (ModelKind::WithEffect, fit),
            None if base.reasons.is_empty() => (ModelKind::Refitted, base.fit),
            None => (ModelKind::AsGiven, as_given),
        };
        // A dependence that simulations cannot include is reported with any model.
        if written != ModelKind::WithEffect {
            fit.unwritten = with_effects.last.unwritten;
        }
        if written == ModelKind::AsGiven {
            account.remarks.push(format!(
                "a refit of friction and grip is not better ({refusal}): model.next.toml is the model as given"
            ));
            withheld.push(Withheld {
                model: ModelKind::Refitted,
                effects: Vec::new(),
                reason: refusal,
            });
        }
        if written == ModelKind::Refitted && fit.final_model.base == self.given.base {
            written = ModelKind::AsGiven;
        }
        let rms = |performance: &Option<Performance>, k: usize| {
            performance.as_ref()?.all().nth(k).map(Squares::rms)
        };
        let baselines = given.all().enumerate().map(|(k, squares)| Baseline {
            quantity: squares.name.clone(),
            unit: squares.unit.to_owned(),
            as_given: squares.rms(),
            refitted: rms(&base.performance, k),
            with_effect: rms(&with_effects.performance, k),
        });
        Ok(Choice {
            fit,
            written,
            baselines: baselines.collect(),
            withheld,
        })
    }

    /// Removes steps until the model is not worse than the given one, or none can be removed; adds
    /// the models that are worse to `withheld`.
    fn without_worse_steps(
        &self,
        mut last: RunFit,
        given: &Performance,
        withheld: &mut Vec<Withheld>,
        account: &mut Account,
    ) -> Result<WithEffects> {
        let contacts = last.final_model.contacts.as_ref();
        let has_contacts = contacts.is_some_and(|contacts| contacts.step.is_some());
        let has_effects = has_contacts || !last.owners.is_empty();
        let mut next = has_effects.then(|| self.trial(&last, given));
        while let Some(trial) = next.take() {
            if trial.reasons.is_empty() {
                // With the base as stated a size may be within its error.
                let Some(step) = self.insignificant_step(&trial.fit, &account.steps) else {
                    return Ok(WithEffects {
                        last,
                        accepted: Some(trial.fit),
                        performance: trial.performance,
                    });
                };
                account.remove_step(step, NO_SIZE);
                let fit = self.without_step(&last, step)?;
                last = self.with_significant_steps(fit, account)?;
                next = (!account.steps.is_empty()).then(|| self.trial(&last, given));
                continue;
            }
            let reason = trial.reasons.join("; ");
            // A dependence that simulations cannot include stays.
            let kept = last.unwritten.as_ref().map(|unwritten| unwritten.step);
            let all = 0..account.steps.len();
            let steps: Vec<usize> = all.filter(|step| Some(*step) != kept).collect();
            let effects = steps.iter().map(|step| account.steps[*step].effect.clone());
            withheld.push(Withheld {
                model: ModelKind::WithEffect,
                effects: effects.collect(),
                reason: reason.clone(),
            });
            let Some((step, fit, shorter)) = self.best_without_a_step(&last, &steps, given)? else {
                account.withhold(&steps, &reason);
                if let Some(unwritten) = &mut last.unwritten {
                    unwritten.step = 0;
                }
                return Ok(WithEffects {
                    last,
                    accepted: None,
                    performance: trial.performance,
                });
            };
            account.remove_step(step, &format!("made other runs worse ({reason})"));
            let remaining = account.steps.len();
            last = self.with_significant_steps(fit, account)?;
            next = match account.steps.len() {
                n if n == remaining => Some(shorter),
                0 => None,
                _ => Some(self.trial(&last, given)),
            };
        }
        Ok(WithEffects {
            last,
            accepted: None,
            performance: None,
        })
    }

    /// The one of these steps without which other runs are simulated best, with the fit without it;
    /// `None` for fewer than two steps.
    fn best_without_a_step(
        &self,
        fit: &RunFit,
        steps: &[usize],
        given: &Performance,
    ) -> Result<Option<(usize, RunFit, Trial)>> {
        let mut best: Option<(usize, RunFit, Trial)> = None;
        for step in steps.iter().filter(|_| steps.len() > 1) {
            let mut without = self.without_step(fit, *step)?;
            self.set_final_estimates(&mut without);
            let trial = self.trial(&without, given);
            if best
                .as_ref()
                .is_none_or(|(_, _, best)| trial.cmp(best).is_lt())
            {
                best = Some((*step, without, trial));
            }
        }
        Ok(best)
    }

    /// Adds to the class of each effect the rivals whose models are better on other runs.
    ///
    /// First-order scores can distinguish two effects by errors of the model that have nothing to do
    /// with either. The rival of largest gain takes the effect's place in a fit of its own, then the
    /// next one, until the effect is not worse.
    fn join_better_rivals(
        &mut self,
        (refitted, fit): (&RunFit, &RunFit),
        (own, given): (&Performance, &Performance),
        account: &mut Account,
    ) -> Result<()> {
        /// Largest number of rivals of an effect that are fitted.
        const MAX_RIVALS: usize = 3;
        let last = account.steps.len().saturating_sub(1);
        for (number, step) in account.steps.iter_mut().enumerate() {
            let outside = |rival: &&mut Rival| !step.class.contains(&rival.effect);
            for rival in step.rivals.iter_mut().filter(outside).take(MAX_RIVALS) {
                let without = match last {
                    0 => refitted.clone(),
                    _ => self.without_step(fit, number)?,
                };
                let amount = Amount::of_rival(rival, f64::NAN);
                let Some(selection) = self.select(&without, &amount) else {
                    continue;
                };
                let mut other = self.add(&without, &selection, last)?.fit;
                self.set_final_estimates(&mut other);
                let trial = self.trial(&other, given);
                let rules = &self.options.rules.search;
                let better = |other: &Performance| !own.worse_than(other, rules).is_empty();
                if !trial.performance.as_ref().is_some_and(better) {
                    break;
                }
                rival.in_class = true;
            }
            let joined = step.rivals.iter().filter(|rival| rival.in_class);
            for effect in joined.map(|rival| &rival.effect) {
                if !step.class.contains(effect) {
                    step.class.push(effect.clone());
                }
            }
        }
        Ok(())
    }

    /// The better base of a fit, refitted or as stated, each with the friction of the replays.
    fn trial(&self, fit: &RunFit, given: &Performance) -> Trial {
        let mut bases = vec![fit.clone()];
        if let Some(other) = &fit.base_as_given {
            let final_model = self.installed_in(&other.final_model, &self.training);
            bases.push(RunFit {
                final_model,
                ..(**other).clone()
            });
        }
        let trial = bases.into_iter().map(|fit| {
            let fit = self.with_replayed_friction(fit, &given.replayed);
            let (performance, reasons) = match self.performance(&fit, Some(&given.replayed)) {
                Ok(performance) => {
                    let reasons = performance.worse_than(given, &self.options.rules.search);
                    (Some(performance), reasons)
                }
                Err(reason) => (None, vec![reason]),
            };
            Trial {
                fit,
                performance,
                reasons,
            }
        });
        trial.min_by(Trial::cmp).expect("a refitted base")
    }

    /// Base parameters that the refit changes by more than the plausible factor.
    pub fn implausible(&self, base: &[Fitted], account: &mut Account) -> Vec<Fitted> {
        let max_factor = self.options.rules.search.plausible;
        let implausible = |(b, fitted): (&usize, &Fitted)| {
            let given = base_value(self.model, *b);
            let factor = fitted.value / given;
            let is_implausible = !(1.0 / max_factor..=max_factor).contains(&factor);
            is_implausible.then(|| {
                account.remarks.push(format!(
                    "{} = {:.4} is {factor:.1} times the given {given:.4}: an error of the model, of a sensor or of the data rather than of this parameter",
                    BASE_NAMES[*b], fitted.value
                ));
                fitted.clone()
            })
        };
        self.free.iter().zip(base).filter_map(implausible).collect()
    }

    /// The model as given, with the discrepancy and the model error of a fit.
    pub fn given_as_in(&self, fit: &RunFit) -> ResidualModel {
        ResidualModel {
            discrepancy: fit.final_model.discrepancy.clone(),
            model_error: fit.final_model.model_error,
            ..self.given.clone()
        }
    }

    /// The fit of the model as given: the estimates of a refit, restated as the given values.
    fn as_given(&self, refitted: &RunFit) -> RunFit {
        let model = self.given_as_in(refitted);
        let final_model = self.installed_in(&model, &self.training);
        let mut estimates = refitted.estimates.clone();
        for (b, estimate) in self.free.iter().zip(&mut estimates) {
            *estimate = estimate.stated_as(final_model.base[*b]);
        }
        RunFit {
            estimates,
            final_model,
            left_out: Vec::new(),
            ..refitted.clone()
        }
    }

    /// Comparison quantities of a fit's model.
    ///
    /// Replays the stated `runs`, or all that are possible.
    fn performance(&self, fit: &RunFit, runs: Option<&[usize]>) -> Result<Performance, String> {
        let read = |model: &ResidualModel| self.read_back(model, fit.already());
        let mut vehicles = vec![read(&fit.final_model)?];
        // Index of the vehicle that each run is replayed with.
        let mut vehicle_index = vec![0; self.data.runs.len()];
        for (session, model) in &fit.left_out {
            for run in session {
                vehicle_index[self.data.locked.training[*run]] = vehicles.len();
            }
            vehicles.push(read(model)?);
        }
        let vehicle_of = |run: usize| &vehicles[vehicle_index[run]];
        let (replayed, replays) = self.replay_squares(vehicle_of, runs)?;
        let held_out = self.installed_in(&fit.final_model, &self.held_out);
        Ok(Performance {
            channels: self.channel_squares(&held_out),
            replays,
            replayed,
        })
    }

    /// Squares of each balance on the held-out runs, at the noise of the model as given: with less
    /// mass all forces are smaller and nothing is explained.
    fn channel_squares(&self, model: &ResidualModel) -> Vec<Squares> {
        let used: Vec<usize> = (0..BALANCES).filter(|c| self.used[*c]).collect();
        let alike = ResidualModel {
            model_error: self.given.model_error,
            ..model.clone()
        };
        let of_run = |frame| -> Vec<Vec<[f64; 2]>> {
            let frame = &without_pushes(frame);
            let rows = with_whole_side(model, frame);
            let [given, noise] = [&self.given, &alike].map(|model| expected(model, frame));
            let pieces = frame.row_count().div_ceil(PIECE_ROWS).max(1);
            let of_channel = |c: &usize| {
                let length = rows[*c].len().div_ceil(pieces).max(1);
                let ratio = given[(*c, *c)] / noise[(*c, *c)];
                let ratio = if ratio.is_finite() { ratio } else { 1.0 };
                let squares = |piece: &[f64]| ratio * piece.iter().map(|r| r * r).sum::<f64>();
                let pieces = rows[*c].chunks(length);
                pieces
                    .map(|piece| [squares(piece), piece.len() as f64])
                    .collect()
            };
            used.iter().map(of_channel).collect()
        };
        let runs: Vec<Vec<Vec<[f64; 2]>>> = self.held_out.par_iter().map(of_run).collect();
        let of_channel = |(k, c): (usize, &usize)| Squares {
            name: CHANNEL_NAMES[*c].0.to_owned(),
            unit: CHANNEL_NAMES[*c].1,
            noise: 0.0,
            pieces: runs.iter().flat_map(|run| run[k].iter().copied()).collect(),
        };
        used.iter().enumerate().map(of_channel).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(pieces: &[f64], noise: f64) -> Squares {
        Squares {
            name: String::new(),
            unit: "",
            noise,
            pieces: pieces.iter().map(|square| [*square, 1.0]).collect(),
        }
    }

    #[test]
    fn a_quantity_is_worse_above_scatter_noise_and_share() {
        let rules = SearchRules::default();
        let before = squares(&[1.0, 1.1, 0.9, 1.0], 0.0);
        let grown = |pieces: &[f64], noise| is_larger(&squares(pieces, noise), &before, &rules);
        assert!(grown(&[2.0, 2.2, 1.9, 2.1], 0.0));
        // One run of four is far worse, the others are not: within the scatter.
        assert!(!grown(&[5.0, 1.1, 0.9, 1.0], 0.0));
        // Worse in each run, by less than the share.
        assert!(!grown(&[1.01, 1.11, 0.91, 1.01], 0.0));
        let quiet = squares(&[1e-4; 4], 1.0);
        assert!(!is_larger(
            &squares(&[1e-2, 1.1e-2, 1e-2, 0.9e-2], 1.0),
            &quiet,
            &rules
        ));
        // The scatter of a single run is unknown.
        assert!(!is_larger(
            &squares(&[2.0], 0.0),
            &squares(&[1.0], 0.0),
            &rules
        ));
        assert!(is_larger(
            &squares(&[5.0], 0.0),
            &squares(&[1.0], 0.0),
            &rules
        ));
    }
}
