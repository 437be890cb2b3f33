//! Verification on held-out data: each effect, and the whole model, must lower the misfit.

use crate::error::Result;
use crate::procedure::evidence::{Account, Evidence, not_named};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::rules::SearchRules;

/// The step that is removed next, with the fit without it.
struct Weakest<F> {
    is_accepted: bool,
    step: usize,
    decrease: Decrease,
    without: F,
}

impl<F> Weakest<F> {
    /// Steps that are not accepted come first, then by strength.
    fn rank(&self) -> (bool, f64) {
        (self.is_accepted, self.decrease.strength())
    }
}

/// Removes steps until the weakest one, and the whole model, lower the held-out misfit.
///
/// Steps are removed one at a time, the weakest first, each with a refit. The held-out data are
/// used for no other decision. `base` and the result are models as they would be written.
pub fn verify<E: Evidence>(
    evidence: &mut E,
    base: &E::Fit,
    mut last: E::Fit,
    account: &mut Account,
    rules: &SearchRules,
) -> Result<E::Fit> {
    let mut reasons = Vec::new();
    let mut all: Option<Decrease> = None;
    while !account.steps.is_empty() {
        let Some(whole) = evidence.misfit_decrease(base, &last)? else {
            break;
        };
        let all = all.get_or_insert_with(|| whole.clone());
        let count = account.steps.len();
        let weakest = weakest_step(evidence, [base, &last], [&whole, all], count, rules)?;
        let is_removed = |weakest: &Weakest<E::Fit>| {
            !weakest.is_accepted || count > 1 && !whole.is_accepted(rules)
        };
        let Some(weakest) = weakest.filter(is_removed) else {
            break;
        };
        let removed = account.steps.remove(weakest.step);
        let decrease = weakest.decrease.in_words(&removed.channel);
        let reason = "the model with it does not lower the misfit on the held-out data enough";
        reasons.push(not_named(&removed, &format!("{reason} ({decrease})")));
        last = if account.steps.is_empty() {
            base.clone()
        } else {
            evidence.remove_superfluous(weakest.without, account)?
        };
    }
    if !reasons.is_empty() {
        account.explain_removal(reasons);
    }
    Ok(last)
}

/// The weakest of the `count` steps of a model; `None` without held-out data. `whole` is the
/// decrease by all of them, `all` that by the steps before any was removed.
fn weakest_step<E: Evidence>(
    evidence: &mut E,
    [base, last]: [&E::Fit; 2],
    [whole, all]: [&Decrease; 2],
    count: usize,
    rules: &SearchRules,
) -> Result<Option<Weakest<E::Fit>>> {
    let mut weakest: Option<Weakest<E::Fit>> = None;
    for step in 0..count {
        // Without its only step a model is the base.
        let (mut without, mut decrease, mut before) = (base.clone(), whole.clone(), 0.0);
        if count > 1 {
            without = evidence.without(last, step)?;
            let Some(by_step) = evidence.misfit_decrease(&without, last)? else {
                continue;
            };
            decrease = by_step;
            // In units of this model's residual: a large effect is far above the final noise.
            let to_base = evidence.misfit_decrease(&without, base)?;
            before = to_base.map_or(0.0, |to| -to.by);
        }
        let decrease = decrease.with_repeatable_part_of(all, before);
        let one = Weakest {
            is_accepted: decrease.is_accepted(rules),
            step,
            decrease,
            without,
        };
        if weakest
            .as_ref()
            .is_none_or(|least| one.rank() < least.rank())
        {
            weakest = Some(one);
        }
    }
    Ok(weakest)
}
