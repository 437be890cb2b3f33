//! Fits of a campaign with its installation errors and discrepancy.

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, RunFit, locked};
use crate::evidence::runs::contacts::run_contacts::without_contacts;
use crate::evidence::runs::fit::gauss_newton::{Fitting, TOLERANCE, residuals};
use crate::evidence::runs::model::discrepancy::Discrepancy;
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::recordings::frame::Frame;

impl Campaign<'_> {
    /// The training runs and the parameters that are fitted to them.
    ///
    /// The plausible factor of a base multiplier is two standard deviations of its prior.
    pub fn fitting(&self) -> Fitting<'_> {
        Fitting {
            frames: &self.training,
            free: &self.free,
            used: self.used,
            stated: self.given.base,
            stated_sd: 0.5 * self.options.rules.search.plausible.ln(),
        }
    }

    /// A fit from a model as it is.
    ///
    /// # Errors
    /// [`Error::BaseFit`] if a residual is not finite.
    pub fn fitted(&self, model: &ResidualModel, owners: Vec<usize>) -> Result<RunFit, Error> {
        let fit = self.fitting().fit(&model.with_fixed(false), TOLERANCE)?;
        Ok(RunFit::new(
            fit.model.with_fixed(true),
            fit.whitener,
            owners,
        ))
    }

    /// A fit from the stated base and installation errors, with a new discrepancy.
    ///
    /// # Errors
    /// [`Error::BaseFit`] if a residual is not finite.
    pub fn fitted_anew(&self, model: &ResidualModel, owners: Vec<usize>) -> Result<RunFit, Error> {
        let start = self.started(model)?;
        self.fitted(&self.with_discrepancy(start), owners)
    }

    /// The model from which a fit starts: the stated base and installation errors, fitted without a
    /// discrepancy.
    ///
    /// # Errors
    /// [`Error::BaseFit`] if a residual is not finite.
    pub fn started(&self, model: &ResidualModel) -> Result<ResidualModel, Error> {
        self.roughly_fitted(&ResidualModel {
            base: self.given.base,
            installation: self.stated_installation(model, &self.training),
            ..model.without_discrepancy()
        })
    }

    /// A fit with a coarse tolerance, as a starting point.
    ///
    /// # Errors
    /// [`Error::BaseFit`] if a residual is not finite.
    pub fn roughly_fitted(&self, model: &ResidualModel) -> Result<ResidualModel, Error> {
        /// Tolerance of the criterion.
        const ROUGH: f64 = 5.0;
        Ok(self.fitting().fit(model, ROUGH)?.model)
    }

    /// A model with the discrepancy estimated from its residuals.
    pub fn with_discrepancy(&self, model: ResidualModel) -> ResidualModel {
        const ROUND: u64 = 6_500_003;
        let by_inputs = self
            .simulator(&model)
            .residuals(&self.training, &model, ROUND);
        let discrepancy = Discrepancy::estimate(
            &self.training,
            [&residuals(&model, &self.training), &by_inputs],
            &self.used,
            self.rules().discrepancy_m,
        );
        ResidualModel {
            discrepancy,
            ..model
        }
    }

    /// Installation errors that the tolerances allow in these runs, with the information of the
    /// track channel.
    fn stated_installation(&self, model: &ResidualModel, frames: &[Frame]) -> Installation {
        let sessions = frames.iter().map(|frame| frame.session.as_str());
        let stated = Installation::new(&self.model.tolerances.unwrap_or_default(), sessions);
        match self.track_information(model, &stated) {
            Some(information) => stated.with_information(information),
            None => stated,
        }
    }

    /// The model with the installation errors and the discrepancy fitted to these runs, with their
    /// priors; base and effects are fixed.
    ///
    /// Installation errors of other runs are not used, since sensors are mounted anew. The model is
    /// returned unchanged without runs, without installation errors, and if a residual is not
    /// finite.
    pub fn installed_in(&self, model: &ResidualModel, frames: &[Frame]) -> ResidualModel {
        let frames: Vec<Frame> = frames.iter().map(without_contacts).collect();
        let names: Vec<&str> = frames.iter().map(|frame| frame.name.as_str()).collect();
        let discrepancy = model.discrepancy.with_fixed(false).at_zero();
        let inputs = format!("{:?}", (names, model.base, &model.effects, &discrepancy));
        let installed = |(installation, discrepancy): (Installation, Discrepancy)| ResidualModel {
            installation,
            discrepancy,
            ..model.clone()
        };
        if let Some(known) = locked(&self.installed).get(&inputs) {
            return installed(known.clone());
        }
        let installation = self.stated_installation(model, &frames);
        if frames.is_empty() || installation.errors.is_empty() {
            return model.clone();
        }
        let effects = model.effects.active.iter();
        let start = ResidualModel {
            installation,
            discrepancy,
            frozen: effects.map(|effect| effect.name.clone()).collect(),
            ..model.clone()
        };
        let fitting = Fitting {
            frames: &frames,
            free: &[],
            ..self.fitting()
        };
        // Without finite residuals there is nothing to fit to.
        let Ok(fit) = fitting.fit(&start, TOLERANCE) else {
            return model.clone();
        };
        let fitted = fit.model.with_fixed(true);
        let fitted = (fitted.installation, fitted.discrepancy);
        locked(&self.installed).insert(inputs, fitted.clone());
        installed(fitted)
    }
}
