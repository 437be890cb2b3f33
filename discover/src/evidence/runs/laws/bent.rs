//! Sensors that are bent, by full refits: a large fault bends the base that scores are taken at, with which they say little of it.

use kufe_sled::effects::Channel;

use crate::evidence::runs::fit::refit::Refit;
use crate::evidence::runs::laws::fitted_law::{FittedLaw, LawFitter};
use crate::evidence::runs::laws::formulas::formula::Formula;
use crate::evidence::runs::laws::formulas::shape::Shape;
use crate::evidence::runs::laws::term::{Term, said_by};
use crate::evidence::runs::screen::residual_screen::ScreenOptions;
use crate::null::sign_flips::chances_of_gains;

impl LawFitter<'_> {
    /// The sensor which, bent in second or in third order of what it says, leaves least, where that is significant run by run; with its
    /// p-value among all of them. `without` is the base alone.
    pub fn bent(&self, without: &Refit, options: &ScreenOptions) -> Option<(FittedLaw, f64)> {
        let without = self.campaign.misfit_by_run(without);
        let mut tried = Vec::new();
        for (channel, kind) in self.channels.iter().enumerate() {
            let Channel::Sensor(sensor) = kind else {
                continue;
            };
            let column = said_by(*sensor);
            let sorted = self.terms.sorted(column);
            if sorted.first() == sorted.last() || !sorted.iter().all(|x| x.is_finite()) {
                continue;
            }
            for shape in [Shape::Power(column, 1.0, 2.0), Shape::Odd(column, 1.0, 3.0)] {
                let law = self.fit_formula(Formula {
                    term: Term { channel, shape },
                    columns: vec![column],
                    gains: Vec::new(),
                });
                let Some((mut law, refit)) =
                    law.and_then(|law| law.refit.clone().map(|r| (law, r)))
                else {
                    continue;
                };
                let with = self.campaign.misfit_by_run(&refit);
                let both = without.iter().zip(&with);
                law.formula.gains = both.map(|(without, with)| 2.0 * (without - with)).collect();
                tried.push(law);
            }
        }
        if tried.is_empty() {
            return None;
        }
        let gains: Vec<&[f64]> = tried.iter().map(|law| &*law.formula.gains).collect();
        let chances = chances_of_gains(&gains, options.flips, options.seed);
        chances
            .into_iter()
            .zip(tried)
            .filter(|(p, _)| *p <= options.alpha_column)
            .min_by(|a, b| a.1.misfit.total_cmp(&b.1.misfit))
            .map(|(p, law)| (law, p))
    }
}
