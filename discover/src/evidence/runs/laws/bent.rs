//! Sensors that are bent, by full refits: a large fault bends the base that scores are taken at, beside which they say little of it.

use kufe_sled::effects::Channel;
use nalgebra::DMatrix;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::polished::LawFit;
use crate::evidence::runs::laws::shape::Shape;
use crate::evidence::runs::laws::sums::{LawSums, total};
use crate::evidence::runs::laws::term::{Term, said_by};
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::screen::leaders::Refit;
use crate::evidence::runs::screen::residual_screen::ScreenOptions;
use crate::null::sign_flips::MaxT;

/// A formula with its sums and its fit.
pub type ToldLaw = (Formula, LawSums, LawFit);

impl Campaign<'_> {
    /// Whether what stands out is large by what it explains.
    pub fn is_large(&self, at: &Current, most: f64) -> bool {
        let rows: usize = self.training.iter().map(|f| f.row_count()).sum();
        most >= self.rules().large * (rows * at.whitener.count()) as f64
    }

    /// The sensor which, bent in second or in third order of what it says, leaves least, where that stands out run by run; with its
    /// p-value among all of them. `without` is the base alone; `told` fits a formula.
    pub fn bent(
        &self,
        without: &Refit,
        terms: &Terms,
        channels: &[Channel],
        told: &dyn Fn(Formula) -> Option<ToldLaw>,
        options: &ScreenOptions,
    ) -> Option<(ToldLaw, f64)> {
        let without = self.misfit_by_run(without);
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
        if tried.is_empty() {
            return None;
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
