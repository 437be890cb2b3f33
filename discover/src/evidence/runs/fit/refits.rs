//! Full refits of base and effect together.

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::{Effort, fit, residuals};
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::{ChannelRows, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::procedure::candidate::Candidate;

/// Base and effect fitted together.
#[derive(Clone)]
pub struct Refit {
    /// What they leave.
    pub misfit: f64,
    /// The effect's size.
    pub size: f64,
    /// The model, the effect last.
    pub model: ResidualModel,
    /// Its rows' whitening.
    pub whitener: Whitener,
}

impl Refit {
    /// The base, and the effects before, as they stand beside the effect.
    fn beside(&self) -> ResidualModel {
        let mut model = self.model.clone();
        model.effects.active.pop();
        model
    }

    fn sized(mut self, candidate: &Candidate<Amplitude>) -> Option<Self> {
        let last = self.model.effects.active.last()?;
        self.size = last.values[candidate.act.parameter];
        Some(self)
    }
}

impl Campaign<'_> {
    /// What base and effect leave when they are fitted together, the effect in its exact form: the criterion of [`fit`] over the training
    /// runs, with what the installation costs; infinite where they cannot be fitted.
    ///
    /// The installation is as it was found, or as it is stated, whichever leaves less: where it is off no model fits without it, and
    /// without the effect it may have been bent to stand for it.
    pub fn misfit_with(&self, at: &Current, candidate: &Candidate<Amplitude>, size: f64) -> f64 {
        let refitted = self.refitted(at.residual_model, candidate, size, Effort::COMPARED);
        refitted.map_or(f64::INFINITY, |refit| refit.misfit)
    }

    /// The same with the model that leaves least, `model` without the effect and `from` being first guesses; nothing where they cannot be
    /// fitted.
    pub fn refitted(
        &self,
        model: &ResidualModel,
        candidate: &Candidate<Amplitude>,
        from: f64,
        effort: Effort,
    ) -> Option<Refit> {
        let with = model.with(candidate.active(from));
        self.beside_either(&with, effort)?.sized(candidate)
    }

    /// The same from where an earlier refit stands, and beside its installation.
    pub fn refitted_from(
        &self,
        earlier: &Refit,
        candidate: &Candidate<Amplitude>,
    ) -> Option<Refit> {
        let with = earlier.beside().with(candidate.active(earlier.size));
        self.fitted_as_it_is(&with, Effort::COMPARED)?
            .sized(candidate)
    }

    /// A model as it is, fitted; its size is 0.
    pub fn refitted_alone(&self, model: &ResidualModel) -> Option<Refit> {
        self.beside_either(model, Effort::COMPARED)
    }

    /// A model fitted beside its own installation, and from the given base beside the stated one: whichever leaves less.
    pub fn beside_either(&self, model: &ResidualModel, effort: Effort) -> Option<Refit> {
        let stated = ResidualModel {
            base: self.given.base,
            installation: Installation::default(),
            ..model.clone()
        };
        let own = (model.installation.cost() > 0.0).then(|| model.hold(true));
        let tried = own.into_iter().chain([stated]);
        tried
            .filter_map(|model| self.fitted_as_it_is(&model, effort))
            .min_by(|a, b| a.misfit.total_cmp(&b.misfit))
    }

    fn fitted_as_it_is(&self, model: &ResidualModel, effort: Effort) -> Option<Refit> {
        let found = fit(model, &self.training, &self.free, self.used, effort).ok()?;
        Some(Refit {
            misfit: found.criterion + found.model.installation.cost(),
            size: 0.0,
            model: found.model,
            whitener: found.whitener,
        })
    }

    /// The misfit by run, but for a constant.
    pub fn misfit_by_run(&self, refit: &Refit) -> Vec<f64> {
        let of_run = |rows: &ChannelRows| {
            let channels = (0..3).filter(|c| self.used[*c]);
            let each = channels.map(|c| {
                let sd = refit.whitener.sd[c];
                let squares: f64 = rows[c].iter().map(|x| (x / sd).powi(2)).sum();
                0.5 * squares + rows[c].len() as f64 * sd.ln()
            });
            each.sum()
        };
        let all = residuals(&refit.model, &self.training);
        all.iter().map(of_run).collect()
    }
}
