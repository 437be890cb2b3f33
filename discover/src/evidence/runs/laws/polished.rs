//! A formula's numbers by full refits, with which those of linearised scores are a first guess.

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::refit::Refit;
use crate::evidence::runs::laws::fitted_law::{FittedLaw, LawFitter};
use crate::evidence::runs::laws::formulas::shapes::moved;
use crate::procedure::candidate::Candidate;

impl LawFitter<'_> {
    /// The formula of the same kind that leaves least: one number after the other is moved, by less and less.
    pub fn polished(&self, law: FittedLaw) -> FittedLaw {
        /// Refits at most.
        const MOST: usize = 30;
        /// Share by which a number is moved at last: less than its error.
        const FINEST: f64 = 1e-3;
        let mut law = law;
        let Some(first) = law.refit.take() else {
            return law;
        };
        let numbers = law.misfit - first.misfit;
        let on = |earlier: &Refit, candidate: &Candidate<Amplitude>| {
            self.campaign.refitted_from(earlier, candidate)
        };
        let again =
            on(&first, &law.candidate).filter(|refit| self.can_be_read(&law.formula, refit.size));
        let mut refit = again.unwrap_or(first);
        let span = law.formula.columns.first().map_or(0.0, |column| {
            let sorted = self.terms.sorted(*column);
            sorted.last().unwrap_or(&0.0) - sorted.first().unwrap_or(&0.0)
        });
        let (mut share, mut refits) = (0.04, 0);
        while share > FINEST && refits < MOST {
            let near = moved(&law.formula.term.shape, span, share);
            if near.is_empty() {
                break;
            }
            refits += near.len();
            let each = near.into_iter().filter_map(|shape| {
                let mut other = law.formula.clone();
                other.term.shape = shape;
                let candidate = self.effect(&other, refit.size)?;
                let found = on(&refit, &candidate)?;
                self.can_be_read(&other, found.size)
                    .then_some((other, candidate, found))
            });
            match each.min_by(|a, b| a.2.misfit.total_cmp(&b.2.misfit)) {
                Some((other, candidate, better)) if better.misfit < refit.misfit => {
                    (law.formula, law.candidate) = (other, candidate);
                    refit = better;
                }
                _ => share *= 0.4,
            }
        }
        (law.size, law.misfit) = (refit.size, refit.misfit + numbers);
        law.refit = Some(refit);
        law
    }
}
