//! Evidence of any kind with stored fits and selections, referred to by index.

use crate::error::Result;
use crate::finding::Step;
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Screen, Selection,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::shared_effects::{Amount, ScreenEstimate, SharesEffects};

/// Evidence of any kind of data, as a trait object.
pub type KindEvidence<'a> = Box<dyn SharesEffects<Act = usize, Fit = usize> + 'a>;

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

    /// Stores a fit and returns its index.
    fn stored(&mut self, fit: Result<E::Fit>) -> Result<usize> {
        self.fits.push(fit?);
        Ok(self.fits.len() - 1)
    }

    /// Stores a selection and returns it with its index as action.
    fn selected(&mut self, selection: Selection<E::Act>) -> Selection<usize> {
        let indexed = selection.with_act(self.selections.len());
        self.selections.push(selection);
        indexed
    }
}

impl<E: Evidence> Evidence for Indexed<E> {
    type Act = usize;
    type Fit = usize;

    fn fit_base(&mut self, account: &mut Account) -> Result<usize> {
        let fit = self.evidence.fit_base(account);
        self.stored(fit)
    }

    fn screen(&mut self, fit: &usize, account: &mut Account) -> Result<Screen<usize>> {
        let screen = self.evidence.screen(&self.fits[*fit], account)?;
        Ok(Screen {
            selection: screen.selection.map(|selection| self.selected(selection)),
            detectable: screen.detectable,
        })
    }

    fn add(
        &mut self,
        fit: &usize,
        selection: &Selection<usize>,
        step: usize,
    ) -> Result<ExtendedFit<usize>> {
        let selection = &self.selections[selection.candidate.act];
        let added = self.evidence.add(&self.fits[*fit], selection, step)?;
        Ok(ExtendedFit {
            fit: self.stored(Ok(added.fit))?,
            is_writable: added.is_writable,
            rms: added.rms,
            place: added.place,
        })
    }

    fn remove_superfluous(&mut self, fit: usize, account: &mut Account) -> Result<usize> {
        let reduced = self
            .evidence
            .remove_superfluous(self.fits[fit].clone(), account);
        self.stored(reduced)
    }

    fn without(&mut self, fit: &usize, step: usize) -> Result<usize> {
        let without = self.evidence.without(&self.fits[*fit], step);
        self.stored(without)
    }

    fn misfit_decrease(&self, from: &usize, to: &usize) -> Result<Option<Decrease>> {
        let [from, to] = [from, to].map(|fit| &self.fits[*fit]);
        self.evidence.misfit_decrease(from, to)
    }

    fn compare(&mut self, base: &usize, last: &usize, steps: &[Step]) -> Result<HeldOutResults> {
        let [base, last] = [base, last].map(|fit| &self.fits[*fit]);
        self.evidence.compare(base, last, steps)
    }

    fn describe(
        &mut self,
        base: &usize,
        last: &usize,
        account: &mut Account,
    ) -> Result<Description> {
        let [base, last] = [base, last].map(|fit| &self.fits[*fit]);
        self.evidence.describe(base, last, account)
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
        Some(self.selected(selection))
    }

    fn amounts(&self, fit: &usize, step: usize) -> Vec<Amount> {
        self.evidence.amounts(&self.fits[*fit], step)
    }

    fn with_fixed_sizes(&mut self, fit: &usize, step: usize, sizes: &[Amount]) -> Result<usize> {
        let fit = &self.fits[*fit];
        let fixed = self.evidence.with_fixed_sizes(fit, step, sizes);
        self.stored(fixed)
    }
}
