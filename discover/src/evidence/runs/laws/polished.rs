//! A formula's numbers by full refits, beside which those of linearised scores are a first guess.

use kufe_sled::effects::{Channel, Kind};

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::Effort;
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::shapes::moved;
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::screen::leaders::Refit;
use crate::procedure::candidate::Candidate;

/// A formula as an effect, fitted together with the base.
pub struct LawFit {
    /// The effect.
    pub candidate: Candidate<Amplitude>,
    /// The fit; nothing where no simulation knows its column.
    pub refit: Option<Refit>,
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
        let Some(first) = shown.refit.clone() else {
            return (formula, shown);
        };
        let numbers = shown.left - first.misfit;
        let on = |model: &ResidualModel, candidate: &Candidate<Amplitude>, size: f64| {
            self.refitted(model, candidate, size, Effort::COMPARED)
        };
        let mut refit = on(&first.beside(), &shown.candidate, first.size).unwrap_or(first);
        (shown.size, shown.left) = (refit.size, refit.misfit + numbers);
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
            let beside = refit.beside();
            let each = near.into_iter().filter_map(|shape| {
                let mut other = formula.clone();
                other.term.shape = shape;
                let candidate = told(&other, refit.size)?;
                let found = on(&beside, &candidate, refit.size)?;
                Some((other, candidate, found))
            });
            match each.min_by(|a, b| a.2.misfit.total_cmp(&b.2.misfit)) {
                Some((other, candidate, better)) if better.misfit < refit.misfit => {
                    formula = other;
                    shown = LawFit {
                        candidate,
                        size: better.size,
                        left: better.misfit + numbers,
                        refit: None,
                    };
                    refit = better;
                }
                _ => share *= 0.4,
            }
        }
        shown.refit = Some(refit);
        (formula, shown)
    }
}
