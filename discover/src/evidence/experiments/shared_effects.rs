//! Friction experiments searched together with other kinds of data.

use crate::error::Error;
use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::evidence::{Experiments, TableFit};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::Selection;
use crate::procedure::shared_effects::{Amount, ScreenEstimate, SharesEffects};

impl SharesEffects for Experiments<'_> {
    fn screen_estimates(&self) -> &[ScreenEstimate] {
        &self.screen_estimates
    }

    /// Aerodynamic effects are those of the body of the experiment, not of the sled on the track.
    fn is_common(&self, effect: &str) -> bool {
        let candidates = self.setting.candidates.iter();
        let Some(candidate) = candidates.into_iter().find(|c| c.effect == effect) else {
            return true;
        };
        self.training.iter().all(|row| {
            let mut denser = row.clone();
            denser.conditions.air_density *= 2.0;
            denser.conditions.drag_area *= 2.0;
            let size = candidate.typical.signum();
            candidate.change(&denser, row.mu, size) == candidate.change(row, row.mu, size)
        })
    }

    fn is_untestable(&self, effect: &str) -> bool {
        self.untestable.iter().any(|(name, _)| name == effect)
    }

    fn select(&mut self, fit: &TableFit, amount: &Amount) -> Option<Selection<FrictionChange>> {
        let candidates = &self.setting.candidates;
        let on = |c: &usize| candidates[*c].effect == amount.effect;
        if fit.chosen.iter().any(on) {
            return None;
        }
        let same = |c: &&Candidate<FrictionChange>| {
            c.effect == amount.effect && c.key == amount.key && !c.is_column()
        };
        let candidate = candidates.iter().find(same)?.clone();
        Some(Selection {
            class: vec![candidate.effect.clone()],
            size: amount.value,
            error: amount.error,
            candidate,
            rivals: Vec::new(),
            p_value: 1.0,
            randomised: Default::default(),
            place: "all rows".to_owned(),
            channel: ("mu", ""),
            remark: None,
            parameters: Vec::new(),
        })
    }

    fn amounts(&self, fit: &TableFit, step: usize) -> Vec<Amount> {
        // The effect added last for this request has the last index.
        let place = step.min(fit.chosen.len().saturating_sub(1));
        let Some(c) = fit.chosen.get(place) else {
            return Vec::new();
        };
        let candidate = &self.setting.candidates[*c];
        let at = self.setting.base.len() + place;
        vec![Amount::of(
            candidate,
            fit.fit.step[at] * candidate.typical,
            fit.fit.errors[at] * candidate.typical,
        )]
    }

    fn with_fixed_sizes(
        &mut self,
        fit: &TableFit,
        step: usize,
        amounts: &[Amount],
    ) -> Result<TableFit, Error> {
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
        Ok(self.fitted(chosen))
    }
}
