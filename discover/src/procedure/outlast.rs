//! Never worse: what is named must lower the gap on data that were locked away, as a whole and step by step.

use crate::error::Error;
use crate::procedure::evidence::{Account, Evidence};
use crate::procedure::rules::SearchRules;

/// What locked-away data say of one model beside another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lowered {
    /// By how much the sum of squares falls, over all channels, each in units of its variance.
    pub by: f64,
    /// Standard error of this fall, from how much it scatters over the data.
    pub error: f64,
    /// What repeats from run to run of the first model's sum of squares; 0 where it is not known.
    pub repeats: f64,
}

impl Lowered {
    /// The sum over independent pieces of data, with the error that their scatter gives; `None` without any.
    pub fn over(falls: &[f64], repeats: f64) -> Option<Self> {
        let n = falls.len() as f64;
        let by: f64 = falls.iter().sum();
        let squares: f64 = falls.iter().map(|fall| (fall - by / n).powi(2)).sum();
        (n > 0.0).then(|| Self {
            by,
            error: (squares * n / (n - 1.0).max(1.0)).sqrt(),
            repeats,
        })
    }

    /// Whether the gap falls beyond its scatter and by a share of what repeats.
    pub fn holds(&self, rules: &SearchRules) -> bool {
        self.by > rules.beyond_scatter * self.error && self.by >= rules.material * self.repeats
    }

    /// How clearly it falls.
    fn strength(&self) -> f64 {
        self.by / self.error.max(1e-300)
    }

    fn told(&self) -> String {
        format!(
            "by {:.1} +- {:.1} units of the noise's variance, of {:.1} that repeat",
            self.by, self.error, self.repeats
        )
    }
}

/// Takes back every step, and at last the whole answer, without which the locked-away data leave no larger gap.
///
/// Steps are left out one at a time, the weakest first, each with a refit of what remains. Nothing but the decision to leave
/// something out is made of the locked-away data. `base` and the result are models as they would be written.
///
/// # Errors
/// Those of the fits.
pub fn outlast<E: Evidence>(
    evidence: &mut E,
    base: &E::Fit,
    last: E::Fit,
    account: &mut Account,
    rules: &SearchRules,
) -> Result<E::Fit, Error> {
    let mut last = last;
    let mut tried = Vec::new();
    while account.steps.len() > 1 {
        let mut weakest: Option<(usize, Lowered)> = None;
        for step in 0..account.steps.len() {
            let without = evidence.without(&last, step)?;
            let Some(lowered) = evidence.lowered(&without, &last)? else {
                continue;
            };
            let weaker = weakest.is_none_or(|(_, w)| lowered.strength() < w.strength());
            if !lowered.holds(rules) && weaker {
                weakest = Some((step, lowered));
            }
        }
        let Some((step, lowered)) = weakest else {
            break;
        };
        tried.push(take_back(account, step, &lowered));
        let without = evidence.without(&last, step)?;
        last = evidence.settle(without, account)?;
    }
    if !account.steps.is_empty()
        && let Some(lowered) = evidence.lowered(base, &last)?
        && !lowered.holds(rules)
    {
        while !account.steps.is_empty() {
            tried.push(take_back(account, 0, &lowered));
        }
        last = base.clone();
    }
    if account.steps.is_empty() && !tried.is_empty() {
        account.depends.clear();
        account.unexplained.get_or_insert(tried.join("; "));
    }
    account.remarks.extend(tried);
    Ok(last)
}

/// Takes a step out of the account and says why.
fn take_back(account: &mut Account, step: usize, lowered: &Lowered) -> String {
    let gone = account.steps.remove(step);
    format!(
        "{} stood out where it was learned (p = {:.1e}), but the model with it does not lower the gap on locked-away data enough ({}): neither named nor written",
        gone.effect,
        gone.p_value,
        lowered.told()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fall_within_its_scatter_or_too_small_to_matter_does_not_hold() {
        let rules = SearchRules::default();
        let of = |by, error, repeats| Lowered { by, error, repeats }.holds(&rules);
        assert!(of(30.0, 5.0, 100.0));
        assert!(!of(-1.0, 5.0, 0.0) && !of(4.0, 5.0, 0.0));
        assert!(!of(4.0, 0.1, 100.0) && of(6.0, 0.1, 100.0));
    }
}
