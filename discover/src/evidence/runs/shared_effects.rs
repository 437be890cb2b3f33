//! Runs searched together with other kinds of data.

use kufe_sled::effects::Kind;

use crate::error::Result;
use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::estimate::estimate;
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::evidence::runs::screen::levels::LevelScore;
use crate::evidence::runs::screen::residual_screen::CandidateScore;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::Selection;
use crate::procedure::shared_effects::{Amount, ScreenEstimate, SharesEffects};

impl SharesEffects for Campaign<'_> {
    fn screen_estimates(&self) -> &[ScreenEstimate] {
        &self.screen_estimates
    }

    fn is_untestable(&self, effect: &str) -> bool {
        let mut untestable = self.candidates.untestable.iter();
        untestable.any(|(name, _)| name == effect)
    }

    fn select(&mut self, fit: &RunFit, amount: &Amount) -> Option<Selection<Amplitude>> {
        let everywhere = [
            self.fresh(&fit.residual_model, &self.candidates.regular),
            self.fresh(&fit.residual_model, &self.candidates.levels),
        ];
        let candidate = everywhere
            .into_iter()
            .flatten()
            .find(|c| c.effect == amount.effect && c.key == amount.key)?;
        // Contacts of this kind's own screen are selected again.
        self.selected_contacts = None;
        let size = match amount.value.clamp(candidate.low, candidate.high) {
            0.0 => 0.1 * candidate.typical,
            size => size,
        };
        let channel = self.strongest_channel(&fit.residual_model, &candidate, size);
        let place = ("all runs", CHANNEL_NAMES[channel]);
        Some(Selection::new(candidate, size, amount.error, place))
    }

    fn amounts(&self, fit: &RunFit, step: usize) -> Vec<Amount> {
        let (after, already) = (&fit.residual_model, fit.already());
        let estimates = if fit.estimates.is_empty() {
            let model = after.with_fixed(false);
            estimate(&self.fitting(), &model, &fit.whitener).estimates
        } else {
            fit.estimates.clone()
        };
        let own = estimates.get(self.free.len()..).unwrap_or_default();
        let amplitudes = after.free().into_iter().zip(own);
        amplitudes
            .filter(|((e, _), _)| *e >= already && fit.owners[*e - already] == step)
            .filter_map(|((e, q), estimate)| {
                let active = &after.effects.active[e];
                let Kind::Catalogue(effect) = &active.kind else {
                    return None;
                };
                let parameter = &effect.info().parameters[q];
                Some(Amount {
                    effect: active.effect_name().to_owned(),
                    key: parameter.name.to_owned(),
                    unit: parameter.unit.to_owned(),
                    value: estimate.value,
                    error: estimate.error,
                })
            })
            .collect()
    }

    fn with_fixed_sizes(
        &mut self,
        fit: &RunFit,
        step: usize,
        amounts: &[Amount],
    ) -> Result<RunFit> {
        let already = fit.already();
        let mut model = fit.residual_model.clone();
        for (place, owner) in fit.owners.iter().enumerate() {
            let active = &mut model.effects.active[already + place];
            let Kind::Catalogue(effect) = active.kind.clone() else {
                continue;
            };
            for amount in amounts.iter().filter(|_| *owner == step) {
                let parameters = effect.info().parameters;
                let at = parameters.iter().position(|p| p.name == amount.key);
                if let Some(at) = at.filter(|_| active.effect_name() == amount.effect) {
                    active.values[at] = amount.value;
                    model.frozen.push(active.name.clone());
                }
            }
        }
        let mut fixed = self.fitted(&model, fit.owners.clone())?;
        fixed.unwritten.clone_from(&fit.unwritten);
        self.set_final_estimates(&mut fixed);
        Ok(fixed)
    }
}

/// Estimates and p-values of a screen within runs.
pub fn within(candidates: &[Candidate<Amplitude>], seen: &[CandidateScore]) -> Vec<ScreenEstimate> {
    let named = candidates.iter().zip(seen);
    named
        .filter(|(c, seen)| seen.usable && !c.is_column() && c.admits(seen.size))
        .map(|(c, seen)| ScreenEstimate {
            amount: Amount::of(c, seen.size, seen.error),
            p_value: seen.p_value,
        })
        .collect()
}

/// Estimates and p-values of a screen between sessions and runs.
pub fn between(candidates: &[Candidate<Amplitude>], seen: &[LevelScore]) -> Vec<ScreenEstimate> {
    let named = candidates.iter().zip(seen);
    named
        .filter(|(c, seen)| seen.error.is_finite() && c.admits(seen.size))
        .map(|(c, seen)| ScreenEstimate {
            amount: Amount::of(c, seen.size, seen.error),
            p_value: seen.p_value,
        })
        .collect()
}
