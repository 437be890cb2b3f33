//! Final estimates of a fit, and installation errors within tolerance.

use nalgebra::DVector;

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::fit::estimate::{Estimate, FinalEstimates, estimate};
use crate::evidence::runs::fit::gauss_newton::stepped;
use crate::evidence::runs::model::installation::InstallationError;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::finding::{SessionOffset, Tolerated};
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

    /// Significant installation errors of all sessions within tolerance; remarks report those
    /// outside.
    pub fn within_tolerance(&self, last: &RunFit, account: &mut Account) -> Vec<Tolerated> {
        let quantile = self.options.rules.search.interval;
        let estimated = installation_errors(last).filter(|(part, _)| part.session.is_none());
        let tolerated = estimated.filter_map(|(part, estimate)| {
            let numbers = [estimate.value, estimate.error, part.sd];
            account.tolerated(part.what.clone(), part.unit, numbers, quantile)
        });
        tolerated.collect()
    }

    /// Significant zero offsets of sensors by session; a remark a sensor reports those outside
    /// their tolerance.
    pub fn session_offsets(&self, last: &RunFit, account: &mut Account) -> Vec<SessionOffset> {
        let quantile = self.options.rules.search.interval;
        let significant = installation_errors(last).filter_map(|(part, estimate)| {
            let is_significant = estimate.value.abs() > quantile * estimate.error;
            is_significant.then_some(SessionOffset {
                sensor: part.sensor()?.name().to_owned(),
                session: part.session.clone()?,
                value: estimate.value,
                error: estimate.error,
                unit: part.unit.to_owned(),
                tolerance: part.sd,
            })
        });
        let offsets: Vec<SessionOffset> = significant.collect();
        let is_outside = |one: &&SessionOffset| {
            one.value.abs() - quantile * one.error > quantile * one.tolerance
        };
        for one in SessionOffset::by_sensor(&offsets) {
            let outside: Vec<&SessionOffset> = one.into_iter().filter(is_outside).collect();
            let ratios = outside.iter().map(|one| one.value.abs() / one.tolerance);
            let Some(largest) = ratios.reduce(f64::max) else {
                continue;
            };
            account.remarks.push(format!(
                "{}, outside its tolerance of {} rad (a standard deviation): it was corrected for and not named",
                SessionOffset::in_words(&outside),
                outside[0].tolerance
            ));
            let what = format!("zero offset of {} by session", outside[0].sensor);
            account.outside_tolerance.push((what, largest));
        }
        offsets
    }
}

/// The installation errors of a fit with their estimates.
fn installation_errors(fit: &RunFit) -> impl Iterator<Item = (&InstallationError, &Estimate)> {
    let errors = &fit.residual_model.installation.errors;
    let first = fit.estimates.len().saturating_sub(errors.len());
    errors.iter().zip(&fit.estimates[first..])
}
