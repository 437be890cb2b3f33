//! What a model file can state of a fit, and what the installation was found to be off by.

use crate::error::Error;
use crate::evidence::runs::campaign::{BESIDE_INSTALLATION, Campaign, RunFit};
use crate::evidence::runs::fit::estimate::Estimated;
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::finding::Tolerated;
use crate::procedure::evidence::Account;

impl Campaign<'_> {
    /// Estimates of a fit with the model that is written of it, and the model that held-out runs are compared with.
    ///
    /// The first is that of the sled itself: base and effects given the installation errors, and given that the stated base is right
    /// within the plausible factor, two standard deviations. Where the data hardly determine a parameter it stays near its stated
    /// value.
    ///
    /// No model file states installation errors. To compare misfits of held-out runs as they were recorded, friction and grip are
    /// fitted once more without them.
    ///
    /// # Errors
    /// Those of the fit.
    pub fn write(&self, fit: &mut RunFit) -> Result<(), Error> {
        let model = fit.residual_model.hold(false);
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
            &refitted.residual_model.hold(false),
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

    /// Adds to the covariance of base and amplitudes what the installation leaves open that no fit could hold.
    fn widen(&self, found: &mut Estimated, model: &ResidualModel, whitener: &Whitener) {
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

    /// What the installation is off by, where that exceeds its error significantly: within its tolerance here, outside it in the remarks.
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
                "{}: {size:.2e} {} +- {half:.1e}, outside its tolerance of {} (a standard deviation): it was allowed for and not named",
                part.what, part.unit, part.sd
            ));
        }
        within
    }
}
