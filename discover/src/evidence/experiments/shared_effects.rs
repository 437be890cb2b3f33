//! Friction experiments searched together with other kinds of data.

use crate::error::Result;
use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::compare::EVERYWHERE;
use crate::evidence::experiments::evidence::Experiments;
use crate::evidence::experiments::fit::Fit;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::Selection;
use crate::procedure::shared_effects::{Amount, ScreenEstimate, SharesEffects};

impl SharesEffects for Experiments<'_> {
    fn screen_estimates(&self) -> &[ScreenEstimate] {
        &self.screen_estimates
    }

    /// Aerodynamic effects are those of the body of the experiment, not of the sled on the track.
    fn is_common(&self, effect: &str) -> bool {
        let mut candidates = self.setting.candidates.iter();
        candidates
            .find(|c| c.effect == effect)
            .is_none_or(|candidate| {
                self.training.iter().all(|row| {
                    let mut denser = row.clone();
                    denser.conditions.air_density *= 2.0;
                    denser.conditions.drag_area *= 2.0;
                    let size = candidate.typical.signum();
                    candidate.change(&denser, row.mu, size) == candidate.change(row, row.mu, size)
                })
            })
    }

    fn is_untestable(&self, effect: &str) -> bool {
        self.untestable.iter().any(|(name, _)| name == effect)
    }

    fn select(&mut self, fit: &Fit, amount: &Amount) -> Option<Selection<FrictionChange>> {
        let candidates = &self.setting.candidates;
        let on = |c: &usize| candidates[*c].effect == amount.effect;
        if fit.chosen.iter().any(on) {
            return None;
        }
        let candidate = candidates
            .iter()
            .find(|c| c.effect == amount.effect && c.key == amount.key && !c.is_column())?;
        let (value, error) = (amount.value, amount.error);
        Some(Selection::new(candidate.clone(), value, error, EVERYWHERE))
    }

    fn amounts(&self, fit: &Fit, step: usize) -> Vec<Amount> {
        // The effect added last for this request has the last index.
        let last = fit.chosen.len().checked_sub(1);
        last.map(|last| fit.amount(&self.setting, step.min(last)))
            .into_iter()
            .collect()
    }

    fn with_fixed_sizes(&mut self, fit: &Fit, step: usize, amounts: &[Amount]) -> Result<Fit> {
        let mut chosen = fit.chosen.clone();
        let candidate = self.setting.candidates[chosen[step]].clone();
        let same = |a: &&Amount| a.effect == candidate.effect && a.key == candidate.key;
        if let Some(amount) = amounts.iter().find(same) {
            chosen[step] = self.setting.candidates.len();
            self.setting.candidates.push(Candidate {
                low: amount.value,
                high: amount.value,
                ..candidate
            });
        }
        Ok(self.fitted(&chosen))
    }
}
