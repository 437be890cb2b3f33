//! Evidence of any kind behind numbers: fits and claims are kept, and asked for by their place.

use crate::error::Error;
use crate::procedure::beside::{Amount, Beside, Chance};
use crate::procedure::evidence::{Account, Added, Claim, Description, Evidence, Opened, Screen};
use crate::procedure::lowered::Lowered;

/// Evidence of a kind that is not named.
pub type Part<'a> = Box<dyn Beside<Act = usize, Fit = usize> + 'a>;

/// Evidence with every fit and claim that it has made.
pub struct Kept<E: Evidence> {
    evidence: E,
    fits: Vec<E::Fit>,
    claims: Vec<Claim<E::Act>>,
}

impl<E: Evidence> Kept<E> {
    /// Nothing fitted yet.
    pub fn new(evidence: E) -> Self {
        Self {
            evidence,
            fits: Vec::new(),
            claims: Vec::new(),
        }
    }

    fn keep(&mut self, fit: E::Fit) -> usize {
        self.fits.push(fit);
        self.fits.len() - 1
    }
}

impl<E: Evidence> Evidence for Kept<E> {
    type Act = usize;
    type Fit = usize;

    fn fit_base(&mut self, account: &mut Account) -> Result<usize, Error> {
        let fit = self.evidence.fit_base(account)?;
        Ok(self.keep(fit))
    }

    fn screen(&mut self, fit: &usize, account: &mut Account) -> Result<Screen<usize>, Error> {
        let screen = self.evidence.screen(&self.fits[*fit], account)?;
        let place = self.claims.len();
        let claim = screen.claim.as_ref().map(|claim| claim.acting(place));
        self.claims.extend(screen.claim);
        Ok(Screen {
            claim,
            detectable: screen.detectable,
        })
    }

    fn add(
        &mut self,
        fit: &usize,
        claim: &Claim<usize>,
        step: usize,
    ) -> Result<Added<usize>, Error> {
        let own = &self.claims[claim.candidate.act];
        let own = self.evidence.add(&self.fits[*fit], own, step)?;
        Ok(Added {
            fit: self.keep(own.fit),
            written: own.written,
            gap: own.gap,
            place: own.place,
        })
    }

    fn settle(&mut self, fit: usize, account: &mut Account) -> Result<usize, Error> {
        let settled = self.evidence.settle(self.fits[fit].clone(), account)?;
        Ok(self.keep(settled))
    }

    fn without(&mut self, fit: &usize, step: usize) -> Result<usize, Error> {
        let without = self.evidence.without(&self.fits[*fit], step)?;
        Ok(self.keep(without))
    }

    fn lowered(&self, from: &usize, to: &usize) -> Result<Option<Lowered>, Error> {
        self.evidence.lowered(&self.fits[*from], &self.fits[*to])
    }

    fn open(&mut self, base: &usize, last: &usize, account: &mut Account) -> Result<Opened, Error> {
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

impl<E: Beside> Beside for Kept<E> {
    fn chances(&self) -> &[Chance] {
        self.evidence.chances()
    }

    fn is_common(&self, effect: &str) -> bool {
        self.evidence.is_common(effect)
    }

    fn lacks(&self, effect: &str) -> bool {
        self.evidence.lacks(effect)
    }

    fn claim(&mut self, fit: &usize, amount: &Amount) -> Option<Claim<usize>> {
        let claim = self.evidence.claim(&self.fits[*fit], amount)?;
        let kept = claim.acting(self.claims.len());
        self.claims.push(claim);
        Some(kept)
    }

    fn amounts(&self, fit: &usize, step: usize) -> Vec<Amount> {
        self.evidence.amounts(&self.fits[*fit], step)
    }

    fn held(&mut self, fit: &usize, step: usize, amounts: &[Amount]) -> Result<usize, Error> {
        let held = self.evidence.held(&self.fits[*fit], step, amounts)?;
        Ok(self.keep(held))
    }
}
