//! Sensors that are bent, by full refits: a large fault bends the base that scores are taken at, beside which they say little of it.

use kufe_sled::effects::Channel;
use nalgebra::DMatrix;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::polished::LawFit;
use crate::evidence::runs::laws::shape::Shape;
use crate::evidence::runs::laws::sums::{LawSums, total};
use crate::evidence::runs::laws::term::{Term, said_by};
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::screen::residual_screen::ScreenOptions;
use crate::null::sign_flips::MaxT;
use crate::procedure::evidence::Claim;

/// A formula with its sums and its fit.
pub type ToldLaw = (Formula, LawSums, LawFit);

impl Campaign<'_> {
    /// Whether what stands out is large: the claim by a full refit, or else the laws by what they explain.
    pub fn is_large(&self, at: &Current, claim: Option<&Claim<Amplitude>>, most: f64) -> bool {
        let rows: usize = self.training.iter().map(|f| f.row_count()).sum();
        let large = self.rules().large * (rows * at.whitener.count()) as f64;
        let of_claim = || {
            let claim = claim.filter(|c| c.candidate.act.carrier.is_none())?;
            let without = self.refitted_alone(at.residual_model)?;
            Some(2.0 * (without.misfit - self.misfit_with(at, &claim.candidate, claim.size)))
        };
        most >= large || of_claim().is_some_and(|gain| gain >= large)
    }

    /// The sensor which, bent in second or in third order of what it says, leaves least, where that stands out run by run; with its
    /// p-value among all of them. `told` fits a formula.
    pub fn bent(
        &self,
        at: &Current,
        terms: &Terms,
        channels: &[Channel],
        told: &dyn Fn(Formula) -> Option<ToldLaw>,
        options: &ScreenOptions,
    ) -> Option<(ToldLaw, f64)> {
        let without = self.misfit_by_run(&self.refitted_alone(at.residual_model)?);
        let mut tried = Vec::new();
        for (channel, kind) in channels.iter().enumerate() {
            let Channel::Sensor(sensor) = kind else {
                continue;
            };
            let column = said_by(*sensor);
            let sorted = terms.sorted(column);
            if sorted.first() == sorted.last() || !sorted.iter().all(|x| x.is_finite()) {
                continue;
            }
            for shape in [Shape::Power(column, 1.0, 2.0), Shape::Odd(column, 1.0, 3.0)] {
                let formula = Formula {
                    term: Term { channel, shape },
                    columns: vec![column],
                    gains: Vec::new(),
                };
                let Some((mut formula, sums, fit)) = told(formula) else {
                    continue;
                };
                let Some(with) = fit.refit.as_ref().map(|refit| self.misfit_by_run(refit)) else {
                    continue;
                };
                let both = without.iter().zip(&with);
                formula.gains = both.map(|(without, with)| 2.0 * (without - with)).collect();
                tried.push((formula, sums, fit));
            }
        }
        let gains = DMatrix::from_fn(tried.len(), without.len(), |c, i| tried[c].0.gains[i]);
        let null = MaxT::by_sign_flips(&gains, options.flips, options.seed);
        let p_of = |law: &ToldLaw| {
            let norm = law.0.gains.iter().map(|g| g * g).sum::<f64>().sqrt();
            null.p_value(total(&law.0.gains).max(0.0) / norm.max(1e-300))
        };
        let stands = tried.into_iter().map(|law| (p_of(&law), law));
        stands
            .filter(|(p, _)| *p <= options.alpha_beyond)
            .min_by(|a, b| a.1.2.left.total_cmp(&b.1.2.left))
            .map(|(p, law)| (law, p))
    }
}
