//! Re-evaluation of a selected effect at the fit that contains it.
//!
//! A large effect biases the base of the screen that selected it, and with it the scores of every
//! candidate. At the fit with the effect, of amplitude a and column c, the residual without it is
//! `r + a c` to first order. Every candidate, the effect included, is scored on that residual. A
//! candidate that explains more, and whose own fit has a smaller misfit, replaces the effect: a
//! model is a sum of single effects, each selected given the others.
//!
//! Source: G. Wang, A. Sarkar, P. Carbonetto, M. Stephens, A simple new approach to variable
//! selection in regression, with application to genetic fine mapping, Journal of the Royal
//! Statistical Society B 82 (2020) 1273.

use nalgebra::DMatrix;

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, Current, RunFit};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::model::design::OWN_LEVELS;
use crate::evidence::runs::screen::residual_screen::{CandidateProducts, screen_runs};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Evidence, SelectedFit, Selection};

/// Largest number of replacements.
const MAX_REPLACEMENTS: usize = 3;

impl Campaign<'_> {
    /// A selected effect or its replacement, with its fit.
    pub fn exchanged(
        &mut self,
        before: &RunFit,
        (mut selection, mut added): SelectedFit<Amplitude, RunFit>,
        step: usize,
        account: &Account,
    ) -> Result<SelectedFit<Amplitude, RunFit>, Error> {
        // The full fit of a law must have a smaller misfit than that of the effect it replaces.
        if let Some(other) = self.runner_up.take() {
            let next = self.add(before, &other, step)?;
            if self.posterior_gain(&added.fit, &next.fit) > -self.rules().laws.number {
                (selection, added) = (other, next);
            }
        }
        for _ in 0..MAX_REPLACEMENTS {
            let Some(again) = self.reevaluated(&added.fit, &selection.candidate, account) else {
                break;
            };
            if again.candidate.is(&selection.candidate) {
                selection = again;
                break;
            }
            // Another amplitude of a named effect belongs to that step: the next screen selects it.
            let mut steps = account.steps.iter();
            if steps.any(|s| s.effect == again.candidate.effect) {
                break;
            }
            let next = self.add(before, &again, step)?;
            if self.posterior_gain(&added.fit, &next.fit) <= 0.0 {
                if !selection.class.contains(&again.candidate.effect) {
                    selection.class.push(again.candidate.effect);
                }
                break;
            }
            (selection, added) = (again, next);
        }
        Ok((selection, added))
    }

    /// The selection on the residual without the last effect of a fit, `named`.
    fn reevaluated(
        &self,
        fit: &RunFit,
        named: &Candidate<Amplitude>,
        account: &Account,
    ) -> Option<Selection<Amplitude>> {
        let model = &fit.residual_model.with_fixed(false);
        let last = model.effects.active.len().checked_sub(1)?;
        let free = model.free();
        let amplitude = free.iter().position(|(e, _)| *e == last)?;
        let scale = model.scale(last, free[amplitude].1);
        let named = Candidate {
            typical: scale,
            ..named.clone()
        };
        let whitener = self.whitener(model);
        let simulator = self.simulator(model);
        let at = Current::new(model, &whitener, &self.free, &simulator, self.form());
        let others = self.everywhere(model);
        let design = at.design(&others);
        let options = self.screen_options(&at, account);
        let mut tested = CandidateProducts::new(&design, &self.training, &simulator, options.pairs);
        // After the other effects of the catalogue, or after all columns outside it.
        let place = if named.is_column() {
            others.len()
        } else {
            others.partition_point(|c| !c.is_column())
        };
        let mut list = others.clone();
        list.insert(place, named);
        let out = MovedColumn {
            from: OWN_LEVELS + self.free.len() + amplitude,
            to: OWN_LEVELS + design.fitted_count() - 1 + place,
            size: model.effects.active[last].values[free[amplitude].1] / scale,
        };
        let parameter = self.free.len() + amplitude;
        let prior = &mut tested.prior;
        prior.precision = prior.precision.clone().remove_row(parameter);
        prior.at = prior.at.clone().remove_row(parameter);
        for (products, noise) in tested.products.iter_mut().zip(&mut tested.noise) {
            products.full = out.of(&products.full);
            products.windows = DMatrix::zeros(0, products.full.ncols());
            *noise = out.of(noise);
        }
        tested.regular = &list;
        let screen = screen_runs(&tested, &self.training, &options);
        self.choose(&at, &screen, &list, &[], account)
    }
}

/// A fitted column that becomes a candidate.
struct MovedColumn {
    /// Its index among all columns.
    from: usize,
    /// Its index after the move.
    to: usize,
    size: f64,
}

impl MovedColumn {
    /// Products of the columns in their new order; the column's contribution is added to the
    /// residual, which is last.
    fn of(&self, products: &DMatrix<f64>) -> DMatrix<f64> {
        let n = products.nrows();
        let last = n - 1;
        let mut all = products.clone();
        let column = all.column(self.from) * self.size;
        let mut residual = all.column_mut(last);
        residual += column;
        let row = all.row(self.from) * self.size;
        let mut residual = all.row_mut(last);
        residual += row;
        let mut order: Vec<usize> = (0..n).filter(|k| *k != self.from).collect();
        order.insert(self.to, self.from);
        DMatrix::from_fn(n, n, |i, j| all[(order[i], order[j])])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of levels, base, an amplitude, two candidates and the residual.
    #[test]
    fn products_are_those_of_the_residual_without_the_effect() {
        let x = DMatrix::from_fn(30, 7, |i, k| (i as f64 * (0.37 + 0.81 * k as f64)).sin());
        let out = MovedColumn {
            from: 3,
            to: 4,
            size: 0.7,
        };
        let order = [0, 1, 2, 4, 3, 5];
        let direct = DMatrix::from_fn(30, 7, |i, k| match order.get(k) {
            Some(column) => x[(i, *column)],
            None => x[(i, 6)] + 0.7 * x[(i, 3)],
        });
        let found = out.of(&x.tr_mul(&x));
        assert!((found - direct.tr_mul(&direct)).abs().max() < 1e-12);
    }
}
