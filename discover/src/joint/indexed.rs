//! Evidence of any kind with stored fits and selections, referred to by index.

use crate::error::Error;
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Screen, Selection,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::shared_effects::{Amount, ScreenEstimate, SharesEffects};

/// Evidence of a kind that is not named.
pub type Part<'a> = Box<dyn SharesEffects<Act = usize, Fit = usize> + 'a>;

/// Evidence with all its fits and selections.
pub struct Indexed<E: Evidence> {
    evidence: E,
    fits: Vec<E::Fit>,
    selections: Vec<Selection<E::Act>>,
}

impl<E: Evidence> Indexed<E> {
    pub fn new(evidence: E) -> Self {
        Self {
            evidence,
            fits: Vec::new(),
            selections: Vec::new(),
        }
    }

    fn store(&mut self, fit: E::Fit) -> usize {
        self.fits.push(fit);
        self.fits.len() - 1
    }
}

impl<E: Evidence> Evidence for Indexed<E> {
    type Act = usize;
    type Fit = usize;

    fn fit_base(&mut self, account: &mut Account) -> Result<usize, Error> {
        let fit = self.evidence.fit_base(account)?;
        Ok(self.store(fit))
    }

    fn screen(&mut self, fit: &usize, account: &mut Account) -> Result<Screen<usize>, Error> {
        let screen = self.evidence.screen(&self.fits[*fit], account)?;
        let place = self.selections.len();
        let selection = screen
            .selection
            .as_ref()
            .map(|selection| selection.acting(place));
        self.selections.extend(screen.selection);
        Ok(Screen {
            selection,
            detectable: screen.detectable,
        })
    }

    fn add(
        &mut self,
        fit: &usize,
        selection: &Selection<usize>,
        step: usize,
    ) -> Result<ExtendedFit<usize>, Error> {
        let own = &self.selections[selection.candidate.act];
        let own = self.evidence.add(&self.fits[*fit], own, step)?;
        Ok(ExtendedFit {
            fit: self.store(own.fit),
            written: own.written,
            gap: own.gap,
            place: own.place,
        })
    }

    fn settle(&mut self, fit: usize, account: &mut Account) -> Result<usize, Error> {
        let settled = self.evidence.settle(self.fits[fit].clone(), account)?;
        Ok(self.store(settled))
    }

    fn without(&mut self, fit: &usize, step: usize) -> Result<usize, Error> {
        let without = self.evidence.without(&self.fits[*fit], step)?;
        Ok(self.store(without))
    }

    fn misfit_decrease(&self, from: &usize, to: &usize) -> Result<Option<Decrease>, Error> {
        self.evidence
            .misfit_decrease(&self.fits[*from], &self.fits[*to])
    }

    fn open(
        &mut self,
        base: &usize,
        last: &usize,
        account: &mut Account,
    ) -> Result<HeldOutResults, Error> {
        self.evidence
            .open(&self.fits[*base], &self.fits[*last], account)
    }

    fn describe(
        &mut self,
        base: &usize,
        last: &usize,
        account: &mut Account,
    ) -> Result<Description, Error> {
        self.evidence
            .describe(&self.fits[*base], &self.fits[*last], account)
    }
}

impl<E: SharesEffects> SharesEffects for Indexed<E> {
    fn screen_estimates(&self) -> &[ScreenEstimate] {
        self.evidence.screen_estimates()
    }

    fn is_common(&self, effect: &str) -> bool {
        self.evidence.is_common(effect)
    }

    fn is_untestable(&self, effect: &str) -> bool {
        self.evidence.is_untestable(effect)
    }

    fn select(&mut self, fit: &usize, amount: &Amount) -> Option<Selection<usize>> {
        let selection = self.evidence.select(&self.fits[*fit], amount)?;
        let stored = selection.acting(self.selections.len());
        self.selections.push(selection);
        Some(stored)
    }

    fn amounts(&self, fit: &usize, step: usize) -> Vec<Amount> {
        self.evidence.amounts(&self.fits[*fit], step)
    }

    fn with_fixed_sizes(
        &mut self,
        fit: &usize,
        step: usize,
        amounts: &[Amount],
    ) -> Result<usize, Error> {
        let fixed = self
            .evidence
            .with_fixed_sizes(&self.fits[*fit], step, amounts)?;
        Ok(self.store(fixed))
    }
}
