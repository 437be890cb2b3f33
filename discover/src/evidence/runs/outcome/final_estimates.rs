//! Final estimates of a fit, and installation errors within tolerance.

use nalgebra::DVector;

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::fit::estimate::{FinalEstimates, estimate};
use crate::evidence::runs::fit::gauss_newton::stepped;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::finding::Tolerated;
use crate::procedure::evidence::Account;

impl Campaign<'_> {
    /// Sets the final estimates of a fit and their model. Effects are also estimated given the base
    /// as stated.
    pub fn set_final_estimates(&self, fit: &mut RunFit) {
        let model = fit.residual_model.with_fixed(false);
        let found = estimate(&self.fitting(), &model, &fit.whitener);
        let stated = found.clone().given_base(&self.free);
        self.set_final(fit, found);
        fit.base_as_given = None;
        let mut base_as_given = fit.clone();
        self.set_final(&mut base_as_given, stated);
        let of_base = base_as_given.estimates.iter_mut().zip(&fit.estimates);
        for (b, (stated, estimate)) in self.free.iter().zip(of_base) {
            *stated = estimate.stated_as(self.given.base[*b]);
        }
        fit.base_as_given = Some(Box::new(base_as_given));
    }

    fn set_final(&self, fit: &mut RunFit, found: FinalEstimates) {
        fit.estimates = found.estimates;
        fit.final_model = found.model.with_fixed(true);
        let scales = self.scales(&fit.final_model);
        let without = |(runs, change): (Vec<usize>, DVector<f64>)| {
            let step: Vec<f64> = change.iter().zip(&scales).map(|(x, by)| x / by).collect();
            (runs, stepped(&fit.final_model, &self.free, &step, 1.0))
        };
        fit.left_out = found.left_out.into_iter().map(without).collect();
    }

    /// Units in which base multipliers and amplitudes are fitted.
    fn scales(&self, model: &ResidualModel) -> Vec<f64> {
        let free = model.free();
        let amplitudes = free.iter().map(|(e, q)| model.scale(*e, *q));
        self.free.iter().map(|_| 1.0).chain(amplitudes).collect()
    }

    /// Significant installation errors within tolerance; remarks report those outside.
    pub fn within_tolerance(&self, last: &RunFit, account: &mut Account) -> Vec<Tolerated> {
        let quantile = self.options.rules.search.interval;
        let parts = &last.residual_model.installation.errors;
        let first = last.estimates.len().saturating_sub(parts.len());
        let estimated = parts.iter().zip(&last.estimates[first..]);
        let tolerated = estimated.filter_map(|(part, estimate)| {
            let numbers = [estimate.value, estimate.error, part.sd];
            account.tolerated(part.what.clone(), part.unit, numbers, quantile)
        });
        tolerated.collect()
    }
}
