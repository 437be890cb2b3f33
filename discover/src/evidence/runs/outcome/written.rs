//! Final estimates of a fit, and installation errors within tolerance.

use crate::error::Error;
use crate::evidence::runs::campaign::{BESIDE_INSTALLATION, Campaign, RunFit};
use crate::evidence::runs::fit::estimate::FinalEstimates;
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::finding::Tolerated;
use crate::procedure::evidence::Account;

impl Campaign<'_> {
    /// Estimates of a fit, the model that is written and the model that is compared on held-out
    /// runs.
    ///
    /// The written model is that of the sled itself: base and effects given the installation
    /// errors, with the stated base as prior: the plausible factor is two standard deviations.
    /// Parameters that the data hardly determine remain near their stated values.
    ///
    /// Installation errors are not part of a model file. For comparisons of held-out runs as
    /// recorded, friction and grip are refitted without them.
    pub fn write(&self, fit: &mut RunFit) -> Result<(), Error> {
        let model = fit.residual_model.with_fixed(false);
        let mut found = self.estimates(&model, &fit.whitener);
        let installed = !fit.residual_model.installation.parts.is_empty();
        if installed {
            self.widen(&mut found, &model, &fit.whitener);
            found.model.installation = Installation::default();
        }
        let sd = 0.5 * self.options.rules.search.plausible.ln();
        let found = found.given_base(&self.free, sd);
        fit.estimates = found.estimates;
        fit.settled = found.model;
        if !installed {
            return Ok(());
        }
        fit.written = Some(fit.settled.clone());
        let effects = &fit.settled.effects.active;
        let frozen = fit.settled.frozen.clone();
        let sized = ResidualModel {
            frozen: effects.iter().map(|e| e.name.clone()).collect(),
            ..fit.settled.clone()
        };
        let refitted = self.fitted(&sized, fit.owners.clone())?;
        let as_recorded = self.newton(
            &refitted.residual_model.with_fixed(false),
            &refitted.whitener,
            &BESIDE_INSTALLATION,
            self.settles(),
        );
        fit.settled = ResidualModel {
            frozen,
            ..as_recorded.model
        };
        Ok(())
    }

    /// Adds the covariance of base and amplitudes due to undetermined installation errors.
    fn widen(&self, found: &mut FinalEstimates, model: &ResidualModel, whitener: &Whitener) {
        let free = model.free();
        let amplitudes = free.iter().map(|(e, q)| model.scale(*e, *q));
        let scales: Vec<f64> = self.free.iter().map(|_| 1.0).chain(amplitudes).collect();
        let mut open = self.undetermined(model, whitener);
        for (k, scale) in scales.iter().enumerate() {
            open.row_mut(k).scale_mut(*scale);
            open.column_mut(k).scale_mut(*scale);
        }
        found.covariance += open;
        for (k, estimate) in found.estimates.iter_mut().take(scales.len()).enumerate() {
            *estimate = estimate.with_error(found.covariance[(k, k)].max(0.0).sqrt());
        }
    }

    /// Significant installation errors within tolerance; remarks report those outside.
    pub fn within_tolerance(&self, last: &RunFit, account: &mut Account) -> Vec<Tolerated> {
        let rules = &self.options.rules.search;
        let parts = &last.residual_model.installation.parts;
        let first = last.estimates.len().saturating_sub(parts.len());
        let mut within = Vec::new();
        for (part, estimate) in parts.iter().zip(&last.estimates[first..]) {
            let (size, half) = (estimate.value, rules.interval * estimate.error);
            if size.abs() <= half {
                continue;
            }
            let tolerated = Tolerated {
                what: part.what.clone(),
                size,
                unit: part.unit.to_owned(),
            };
            if size.abs() - half <= rules.interval * part.sd {
                within.push(tolerated);
                continue;
            }
            account.remarks.push(format!(
                "{}: {size:.2e} {} +- {half:.1e}, outside its tolerance of {} (a standard deviation): it was corrected for and not named",
                part.what, part.unit, part.sd
            ));
        }
        within
    }
}
