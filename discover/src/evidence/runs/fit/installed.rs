//! Fits of a campaign with its installation errors and discrepancy.

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, RunFit, locked};
use crate::evidence::runs::contacts::own::without_contacts;
use crate::evidence::runs::fit::gauss_newton::{Fitting, residuals};
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
        let fit = self.fitting().fit(&model.with_fixed(false))?;
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
        const ROUND: u64 = 6_500_003;
        /// Tolerance of the criterion without a discrepancy: the fit with one starts there.
        const START: f64 = 5.0;
        let start = ResidualModel {
            base: self.given.base,
            installation: self.stated_installation(model, &self.training),
            ..model.without_discrepancy()
        };
        let start = self.fitting().fit_within(&start, START)?.model;
        let by_inputs = self
            .simulator(&start)
            .residuals(&self.training, &start, ROUND);
        let discrepancy = Discrepancy::estimate(
            &self.training,
            [&residuals(&start, &self.training), &by_inputs],
            &self.used,
            self.rules().discrepancy_m,
        );
        let start = ResidualModel {
            discrepancy,
            ..start
        };
        self.fitted(&start, owners)
    }

    /// Installation errors that the tolerances allow in these runs, with the information of the
    /// track channel.
    fn stated_installation(&self, model: &ResidualModel, frames: &[Frame]) -> Installation {
        let sessions = frames.iter().map(|frame| frame.session.as_str());
        let stated = Installation::new(&self.model.tolerances.unwrap_or_default(), sessions);
        match self.track_information(model, &stated) {
            Some(information) => stated.informed(information),
            None => stated,
        }
    }

    /// The model with the installation errors and the discrepancy of these runs.
    ///
    /// Both have their priors; base and effects are given. Installation errors of other runs are
    /// not used, since sensors are mounted anew.
    pub fn installed_in(&self, model: &ResidualModel, frames: &[Frame]) -> ResidualModel {
        let frames: Vec<Frame> = frames.iter().map(without_contacts).collect();
        let names: Vec<&str> = frames.iter().map(|frame| frame.name.as_str()).collect();
        let (effects, discrepancy) = (&model.effects, &model.discrepancy);
        let inputs = format!("{:?}", (names, model.base, effects, discrepancy));
        let installed = |(installation, discrepancy): (Installation, Discrepancy)| ResidualModel {
            installation,
            discrepancy,
            ..model.clone()
        };
        if let Some(known) = locked(&self.installed).get(&inputs) {
            return installed(known.clone());
        }
        let installation = self.stated_installation(model, &frames);
        if frames.is_empty() || installation.parts.is_empty() {
            return model.clone();
        }
        let effects = model.effects.active.iter();
        let start = ResidualModel {
            installation,
            discrepancy: model.discrepancy.with_fixed(false).at_zero(),
            frozen: effects.map(|effect| effect.name.clone()).collect(),
            ..model.clone()
        };
        let fitting = Fitting {
            frames: &frames,
            free: &[],
            ..self.fitting()
        };
        // Without finite residuals there is nothing to fit to.
        let Ok(fit) = fitting.fit(&start) else {
            return model.clone();
        };
        let fitted = fit.model.with_fixed(true);
        let fitted = (fitted.installation, fitted.discrepancy);
        locked(&self.installed).insert(inputs, fitted.clone());
        installed(fitted)
    }
}
