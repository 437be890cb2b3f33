//! What a model file can state of a fit, and what the installation was found to be off by.

use crate::error::Error;
use crate::evidence::runs::campaign::{BESIDE_INSTALLATION, Campaign, RunFit};
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::finding::Tolerated;
use crate::procedure::evidence::Account;

impl Campaign<'_> {
    /// Estimates of a fit, and the model that is written of it.
    ///
    /// Sizes of effects are those with an installation that may be off. A model file states no such errors: friction and grip
    /// are fitted once more to the runs as they were recorded. Their intervals are of what is true: as wide as with the installation, and
    /// by as much as its errors have moved them.
    ///
    /// # Errors
    /// Those of the fit.
    pub fn write(&self, fit: &mut RunFit) -> Result<(), Error> {
        let (estimates, settled) = self.estimates(&fit.residual_model.hold(false), &fit.whitener);
        (fit.estimates, fit.settled) = (estimates, settled);
        if fit.residual_model.installation.parts.is_empty() {
            return Ok(());
        }
        self.widen(fit);
        let frozen = fit.settled.frozen.clone();
        let itself = ResidualModel {
            installation: Installation::default(),
            ..fit.settled.clone()
        };
        fit.conditional = Some((fit.estimates.clone(), itself));
        let sized = ResidualModel {
            installation: Installation::default(),
            frozen: fit
                .settled
                .effects
                .active
                .iter()
                .map(|e| e.name.clone())
                .collect(),
            ..fit.settled.clone()
        };
        let refitted = self.fitted(&sized, fit.owners.clone())?;
        let (base, written) = self.newton(
            &refitted.residual_model.hold(false),
            &refitted.whitener,
            &BESIDE_INSTALLATION,
            self.settles(),
        );
        for (estimate, written) in fit.estimates.iter_mut().zip(&base) {
            *estimate = estimate.stated_as(written.value);
        }
        fit.settled = ResidualModel { frozen, ..written };
        Ok(())
    }

    /// Adds to the errors of base and amplitudes what the installation leaves open that no fit could hold.
    fn widen(&self, fit: &mut RunFit) {
        let model = fit.residual_model.hold(false);
        let open = self.left_open(&model, &fit.whitener);
        let free = model.free();
        let amplitudes = free.iter().map(|(e, q)| model.scale(*e, *q));
        let scales = self.free.iter().map(|_| 1.0).chain(amplitudes);
        for ((estimate, open), scale) in fit.estimates.iter_mut().zip(open).zip(scales) {
            *estimate = estimate.with_error(estimate.error.hypot(open * scale));
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
