//! Verification on held-out data: each effect, and the whole model, must lower the misfit.

use crate::error::Error;
use crate::procedure::evidence::{Account, Evidence};
use crate::procedure::lowered::Lowered;
use crate::procedure::rules::SearchRules;

/// Removes every step, and finally the whole model, that does not lower the held-out misfit.
///
/// Steps are removed one at a time, the weakest first, each with a refit. The held-out data are
/// used for no other decision. `base` and the result are models as they would be written.
pub fn outlast<E: Evidence>(
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
        false => evidence.lowered(base, &last)?,
    };
    let all = whole.clone();
    while account.steps.len() > 1 {
        let mut weakest: Option<(usize, Lowered, E::Fit)> = None;
        for step in 0..account.steps.len() {
            let without = evidence.without(&last, step)?;
            let Some(lowered) = evidence.lowered(&without, &last)? else {
                continue;
            };
            // In units of this model's residual: a large effect is far above the final noise.
            let before = evidence.lowered(&without, base)?.map_or(0.0, |to| -to.by);
            let lowered = match &all {
                Some(all) => lowered.of_all(all, before),
                None => lowered,
            };
            let weaker = weakest
                .as_ref()
                .is_none_or(|(_, w, _)| lowered.strength() < w.strength());
            if !lowered.holds_in(&account.steps[step].channel, rules) && weaker {
                weakest = Some((step, lowered, without));
            }
        }
        let Some((step, lowered, without)) = weakest else {
            break;
        };
        tried.push(take_back(account, step, &lowered));
        last = evidence.settle(without, account)?;
        whole = evidence.lowered(base, &last)?;
    }
    if !account.steps.is_empty()
        && let Some(lowered) = whole
        && !match &account.steps[..] {
            [one] => lowered.holds_in(&one.channel, rules),
            _ => lowered.holds(rules),
        }
    {
        while !account.steps.is_empty() {
            tried.push(take_back(account, 0, &lowered));
        }
        last = base.clone();
    }
    match account.steps.is_empty() && !tried.is_empty() {
        true => account.is_left_without(tried),
        false => account.remarks.extend(tried),
    }
    Ok(last)
}

/// Removes a step from the account and reports why.
fn take_back(account: &mut Account, step: usize, lowered: &Lowered) -> String {
    let gone = account.steps.remove(step);
    format!(
        "{} is significant on the training data (p = {:.1e}), but the model with it does not lower the misfit on the held-out data enough ({}): not named",
        gone.effect,
        gone.p_value,
        lowered.in_words(&gone.channel)
    )
}
