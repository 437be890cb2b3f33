//! A formula's numbers by full refits, beside which those of linearised scores are a first guess.

use kufe_sled::effects::{Channel, Kind};

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::shapes::moved;
use crate::evidence::runs::laws::terms::Terms;
use crate::procedure::candidate::Candidate;

/// A formula as an effect, fitted together with the base.
pub struct LawFit {
    /// The effect.
    pub candidate: Candidate<Amplitude>,
    /// Its size.
    pub size: f64,
    /// What it leaves, its numbers counted.
    pub left: f64,
}

/// Where a refit starts: a sensor's law of a size that is found to first order may have no inverse.
pub fn start(candidate: &Candidate<Amplitude>, size: f64) -> f64 {
    match &candidate.act.kind {
        Kind::Custom(own) if matches!(own.channel, Channel::Sensor(_)) => 0.3 * size,
        _ => size,
    }
}

impl Campaign<'_> {
    /// The formula of the same kind that leaves least: one number after the other is moved, by less and less. `told` makes it an effect.
    pub fn polished(
        &self,
        at: &Current,
        formula: Formula,
        shown: LawFit,
        terms: &Terms,
        told: &dyn Fn(&Formula, f64) -> Option<Candidate<Amplitude>>,
    ) -> (Formula, LawFit) {
        /// Refits at most.
        const MOST: usize = 30;
        /// Share by which a number is moved at last: less than its error.
        const FINEST: f64 = 1e-3;
        let (mut formula, mut shown) = (formula, shown);
        let first = start(&shown.candidate, shown.size);
        let Some((misfit, size)) = self.refitted(at, &shown.candidate, first) else {
            return (formula, shown);
        };
        let numbers = shown.left - misfit;
        shown.size = size;
        let span = formula.columns.first().map_or(0.0, |column| {
            let sorted = terms.sorted(*column);
            sorted.last().unwrap_or(&0.0) - sorted.first().unwrap_or(&0.0)
        });
        let (mut share, mut refits) = (0.04, 0);
        while share > FINEST && refits < MOST {
            let near = moved(&formula.term.shape, span, share);
            if near.is_empty() {
                break;
            }
            refits += near.len();
            let each = near.into_iter().filter_map(|shape| {
                let mut other = formula.clone();
                other.term.shape = shape;
                let candidate = told(&other, shown.size)?;
                let (misfit, size) = self.refitted(at, &candidate, shown.size)?;
                let left = misfit + numbers;
                Some((
                    other,
                    LawFit {
                        candidate,
                        size,
                        left,
                    },
                ))
            });
            match each.min_by(|a, b| a.1.left.total_cmp(&b.1.left)) {
                Some((other, better)) if better.left < shown.left => {
                    (formula, shown) = (other, better);
                }
                _ => share *= 0.4,
            }
        }
        (formula, shown)
    }
}
