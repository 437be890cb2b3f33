//! Full refits of base and effect together.

use std::sync::Arc;

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, Current, RunFit};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::{Effort, fit, residuals};
use crate::evidence::runs::fit::refit::Refit;
use crate::evidence::runs::fit::row_noise::log_noise_of;
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::{ChannelRows, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;

impl Campaign<'_> {
    /// Base and candidate fitted together, the effect in its exact form, from next to nothing on the side where a screen saw it; nothing
    /// where they cannot be fitted. Made once for each candidate.
    ///
    /// The installation is as it was found, or as it is stated, whichever leaves less: where it is off no model fits without it, and
    /// without the effect it may have been bent to represent it.
    pub fn refitted_at(
        &self,
        at: &Current,
        candidate: &Candidate<Amplitude>,
        size: f64,
    ) -> Option<Arc<Refit>> {
        self.refitted_below(at, candidate, size, f64::INFINITY)
    }

    /// The same where it leaves no more than `beat`; given up as soon as that is out of reach.
    pub fn refitted_below(
        &self,
        at: &Current,
        candidate: &Candidate<Amplitude>,
        size: f64,
        beat: f64,
    ) -> Option<Arc<Refit>> {
        at.refits.below(candidate, beat, || {
            self.refitted_beside(at, candidate, size, beat)
        })
    }

    /// The same, not stored.
    fn refitted_beside(
        &self,
        at: &Current,
        candidate: &Candidate<Amplitude>,
        size: f64,
        beat: f64,
    ) -> Option<Refit> {
        let from = 0.01 * candidate.typical.copysign(size);
        let with = at.residual_model.with(candidate.active(from));
        if self.out_of_reach(at, &with, beat) {
            return None;
        }
        self.beside_either(&with, Effort::COMPARED, beat)?
            .sized(candidate)
    }

    /// The model as it is, fitted; its size is 0. Made once.
    pub fn refitted_alone<'r>(&self, at: &'r Current) -> Option<&'r Refit> {
        let alone = || self.beside_either(at.residual_model, Effort::COMPARED, f64::INFINITY);
        at.refits.alone(alone)
    }

    /// A candidate fitted together with `model`, which does not contain it, `from` being a first guess.
    pub fn refitted(
        &self,
        model: &ResidualModel,
        candidate: &Candidate<Amplitude>,
        from: f64,
        effort: Effort,
    ) -> Option<Refit> {
        let with = model.with(candidate.active(from));
        self.beside_either(&with, effort, f64::INFINITY)?
            .sized(candidate)
    }

    /// The same from the result of an earlier refit, and with its installation.
    pub fn refitted_from(
        &self,
        earlier: &Refit,
        candidate: &Candidate<Amplitude>,
    ) -> Option<Refit> {
        let with = earlier
            .without_effect()
            .with(candidate.active(earlier.size));
        self.fitted_as_it_is(&with, Effort::COMPARED, f64::INFINITY)?
            .sized(candidate)
    }

    /// A model fitted with its own installation, and from the given base with the stated one: whichever leaves less. A fit that cannot
    /// leave less than `beat`, or than the other, is given up on the way.
    pub fn beside_either(&self, model: &ResidualModel, effort: Effort, beat: f64) -> Option<Refit> {
        self.beside_either_on(&self.training, model, (effort, beat))
    }

    /// The same on some runs, which bear their share of what the installation costs.
    pub fn beside_either_on(
        &self,
        frames: &[Frame],
        model: &ResidualModel,
        (effort, beat): (Effort, f64),
    ) -> Option<Refit> {
        let stated = ResidualModel {
            base: self.given.base,
            installation: Installation::default(),
            ..model.clone()
        };
        let installed = model.installation.cost() > 0.0;
        let own = installed.then(|| self.fitted_on(frames, &model.hold(true), (effort, beat)));
        let own = own.flatten();
        let beat = own.as_ref().map_or(beat, |own| own.misfit.min(beat));
        let tried = [own, self.fitted_on(frames, &stated, (effort, beat))];
        let tried = tried.into_iter().flatten();
        tried.min_by(|a, b| a.misfit.total_cmp(&b.misfit))
    }

    fn fitted_as_it_is(&self, model: &ResidualModel, effort: Effort, beat: f64) -> Option<Refit> {
        self.fitted_on(&self.training, model, (effort, beat))
    }

    fn fitted_on(
        &self,
        frames: &[Frame],
        model: &ResidualModel,
        (effort, beat): (Effort, f64),
    ) -> Option<Refit> {
        let found = fit(model, frames, &self.free, self.used, effort, beat).ok()?;
        let share = frames.len() as f64 / self.training.len() as f64;
        Some(Refit {
            misfit: found.criterion + share * found.model.installation.cost(),
            size: 0.0,
            model: found.model,
            whitener: found.whitener,
        })
    }

    /// The misfit by run, but for a constant: of what the installation costs each has the same share.
    pub fn misfit_by_run(&self, refit: &Refit) -> Vec<f64> {
        let (model, whitener) = (&refit.model, &refit.whitener);
        let cost = model.installation.cost() / self.training.len().max(1) as f64;
        let runs = self.left_by_run(model, whitener).into_iter();
        runs.map(|misfit| cost + misfit).collect()
    }

    /// What a model leaves of each run, but for a constant and what its installation costs.
    pub fn left_by_run(&self, model: &ResidualModel, whitener: &Whitener) -> Vec<f64> {
        let of_run = |(frame, rows): (&Frame, &ChannelRows)| {
            let squares: f64 = whitener.apply(rows).iter().map(|x| x * x).sum();
            let noise = log_noise_of(model, frame, self.used);
            0.5 * squares + frame.row_count() as f64 * (whitener.log_scale() - noise)
        };
        let all = residuals(model, &self.training);
        self.training.iter().zip(&all).map(of_run).collect()
    }

    /// A candidate fitted from the given base, nothing found of the installation, where that leaves no more than `beat`.
    pub fn refitted_bare(
        &self,
        at: &Current,
        candidate: Option<(&Candidate<Amplitude>, f64)>,
        beat: f64,
    ) -> Option<Refit> {
        let bare = ResidualModel {
            base: self.given.base,
            installation: Installation::default(),
            ..at.residual_model.clone()
        };
        let Some((candidate, size)) = candidate else {
            return self.fitted_as_it_is(&bare, Effort::COMPARED, beat);
        };
        let from = 0.01 * candidate.typical.copysign(size);
        let with = bare.with(candidate.active(from));
        let refit = self.fitted_as_it_is(&with, Effort::COMPARED, beat)?;
        (refit.misfit <= beat).then(|| refit.sized(candidate))?
    }

    /// A refit with which what the installation is off by is found anew, to be judged by [`misfit_by_run`](Self::misfit_by_run) (its own
    /// misfit and size are those of before); nothing where that cannot be fitted.
    pub fn installed_anew(&self, refit: &Refit) -> Option<Refit> {
        self.installed_by(refit, |fit| self.installed(fit))
    }

    /// The same, or the refit as it is where that leaves less.
    pub fn best_installed(&self, refit: &Refit) -> Refit {
        let misfit = |refit: &Refit| self.misfit_by_run(refit).iter().sum::<f64>();
        let anew = self.installed_anew(refit);
        anew.filter(|anew| misfit(anew) < misfit(refit))
            .unwrap_or_else(|| refit.clone())
    }

    /// The same with delays no further apart than is stated.
    pub fn installed_with_stated_clocks(&self, refit: &Refit) -> Option<Refit> {
        self.installed_by(refit, |fit| self.installed_as_stated(fit))
    }

    fn installed_by(
        &self,
        refit: &Refit,
        find: impl Fn(&RunFit) -> Result<RunFit, Error>,
    ) -> Option<Refit> {
        let fit = RunFit::new(refit.model.clone(), refit.whitener.clone(), Vec::new());
        let found = find(&fit).ok()?;
        Some(Refit {
            model: found.residual_model,
            whitener: found.whitener,
            ..*refit
        })
    }
}
