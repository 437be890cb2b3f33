//! Verification on held-out data: each effect, and the whole model, must lower the misfit.

use crate::error::Error;
use crate::procedure::evidence::{Account, Evidence};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::rules::SearchRules;

/// Removes every step, and finally the whole model, that does not lower the held-out misfit.
///
/// Steps are removed one at a time, the weakest first, each with a refit. The held-out data are
/// used for no other decision. `base` and the result are models as they would be written.
pub fn verify<E: Evidence>(
    evidence: &mut E,
    base: &E::Fit,
    last: E::Fit,
    account: &mut Account,
    rules: &SearchRules,
) -> Result<E::Fit, Error> {
    let mut last = last;
    let mut tried = Vec::new();
    let mut whole = match account.steps.is_empty() {
        true => None,
        false => evidence.misfit_decrease(base, &last)?,
    };
    let all = whole.clone();
    while account.steps.len() > 1 {
        let mut weakest: Option<(usize, Decrease, E::Fit)> = None;
        for step in 0..account.steps.len() {
            let without = evidence.without(&last, step)?;
            let Some(decrease) = evidence.misfit_decrease(&without, &last)? else {
                continue;
            };
            // In units of this model's residual: a large effect is far above the final noise.
            let before = evidence
                .misfit_decrease(&without, base)?
                .map_or(0.0, |to| -to.by);
            let decrease = match &all {
                Some(all) => decrease.of_all(all, before),
                None => decrease,
            };
            let weaker = weakest
                .as_ref()
                .is_none_or(|(_, w, _)| decrease.strength() < w.strength());
            if !decrease.is_accepted_in(&account.steps[step].channel, rules) && weaker {
                weakest = Some((step, decrease, without));
            }
        }
        let Some((step, decrease, without)) = weakest else {
            break;
        };
        tried.push(remove(account, step, &decrease));
        last = evidence.settle(without, account)?;
        whole = evidence.misfit_decrease(base, &last)?;
    }
    if !account.steps.is_empty()
        && let Some(decrease) = whole
        && !match &account.steps[..] {
            [one] => decrease.is_accepted_in(&one.channel, rules),
            _ => decrease.is_accepted(rules),
        }
    {
        while !account.steps.is_empty() {
            tried.push(remove(account, 0, &decrease));
        }
        last = base.clone();
    }
    match account.steps.is_empty() && !tried.is_empty() {
        true => account.set_unexplained(tried),
        false => account.remarks.extend(tried),
    }
    Ok(last)
}

/// Removes a step from the account and reports why.
fn remove(account: &mut Account, step: usize, decrease: &Decrease) -> String {
    let gone = account.steps.remove(step);
    format!(
        "{} is significant on the training data (p = {:.1e}), but the model with it does not lower the misfit on the held-out data enough ({}): not named",
        gone.effect,
        gone.p_value,
        decrease.in_words(&gone.channel)
    )
}
