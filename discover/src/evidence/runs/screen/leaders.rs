//! The leaders of a screen, held against one another by full refits: a large effect has bent the base that scores are taken at.

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::{Effort, fit, residuals};
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::{ChannelRows, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::screen::residual_screen::RunScreen;
use crate::procedure::candidate::Candidate;

/// Most leaders that are refitted.
const MOST: usize = 3;

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
    pub fn beside(&self) -> ResidualModel {
        let mut model = self.model.clone();
        model.effects.active.pop();
        model
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
        let sized = |mut refit: Refit| {
            refit.size = refit.model.effects.active.last()?.values[candidate.act.parameter];
            Some(refit)
        };
        self.beside_either(&with, effort).and_then(sized)
    }

    /// A model as it is, fitted; its size is 0.
    pub fn refitted_alone(&self, model: &ResidualModel) -> Option<Refit> {
        self.beside_either(model, Effort::COMPARED)
    }

    /// A model fitted beside its own installation, and beside the stated one: whichever leaves less.
    fn beside_either(&self, model: &ResidualModel, effort: Effort) -> Option<Refit> {
        let stated = ResidualModel {
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

    /// Of the effects that explain nearly as much as the named one, that which leaves least after a full refit; the named one
    /// where it is small. `claimable` says which may be claimed.
    pub fn leader(
        &self,
        at: &Current,
        screen: &RunScreen,
        list: &[Candidate<Amplitude>],
        named: usize,
        claimable: &dyn Fn(usize) -> bool,
    ) -> usize {
        let rules = self.rules();
        let gain = |c: usize| screen.seen[c].gain;
        let rows: usize = self.training.iter().map(|f| f.row_count()).sum();
        if gain(named) < rules.large * (rows * at.whitener.count()) as f64 {
            return named;
        }
        let mut leaders: Vec<usize> = (0..list.len())
            .filter(|c| *c == named || gain(*c) >= rules.leads * gain(named) && claimable(*c))
            .filter(|c| list[*c].is_column() == list[named].is_column())
            .collect();
        leaders.sort_by(|a, b| gain(*b).total_cmp(&gain(*a)));
        let mut effects: Vec<&str> = Vec::new();
        leaders.retain(|c| {
            let effect = list[*c].effect.as_str();
            let first = !effects.contains(&effect);
            effects.push(effect);
            first || *c == named
        });
        leaders.truncate(MOST);
        if leaders.len() < 2 {
            return named;
        }
        let misfit = |c: usize| self.misfit_with(at, &list[c], screen.seen[c].size);
        let judged = leaders.into_iter().map(|c| (c, misfit(c)));
        judged
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(named, |(c, _)| c)
    }
}
