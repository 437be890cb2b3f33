//! The leaders of a screen, compared with one another by full refits: a large effect has bent the base that scores are taken at, and
//! with it what they say of it.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::evidence::runs::campaign::{Campaign, Current, RunFit};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::refit::Refit;
use crate::evidence::runs::fit::row_noise::far_less_beyond;
use crate::evidence::runs::laws::sums::{difference, total};
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ResidualModel};
use crate::evidence::runs::recordings::noise::sensors::NoiseFrom;
use crate::evidence::runs::screen::residual_screen::{RunScreen, ScreenOptions};
use crate::finding::Rival;
use crate::null::clusters::{by_sessions, session_numbers};
use crate::null::sign_flips::chances_of_gains;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Randomised, Selection};

/// A candidate with what its full refit explains.
pub struct Leader<'a> {
    /// The candidate.
    pub candidate: &'a Candidate<Amplitude>,
    /// Its place in the screen.
    pub at: usize,
    /// Its refit.
    pub refit: Arc<Refit>,
    /// What it explains, by run.
    pub gains: Vec<f64>,
}

impl Campaign<'_> {
    /// Whether what is significant is large by what it explains.
    pub fn is_large(&self, at: &Current, most: f64) -> bool {
        let rows: usize = self.training.iter().map(|f| f.row_count()).sum();
        most >= self.rules().large * (rows * at.whitener.count()) as f64
    }

    /// A fit that counts as above the noise what it leaves, where that is far less than the residual of the model before it.
    pub fn with_less_beyond(&self, mut fit: RunFit) -> RunFit {
        if let Some(less) = far_less_beyond(
            &fit.residual_model,
            &self.training,
            self.used,
            self.rules().less_beyond,
        ) {
            fit.residual_model.beyond_noise = less;
            fit.settled.beyond_noise = less;
        }
        fit
    }

    /// Where something is large, the model with what the balances leave above noise with the effect of the catalogue that explains most in
    /// a full refit, if that is far less; refits and what they explain are evaluated with it, else what the effect leaves counts as noise.
    /// `contacts` as in [`leading`](Self::leading).
    pub fn beside_leader(
        &self,
        at: &Current,
        screen: &RunScreen,
        regular: &[Candidate<Amplitude>],
        contacts: f64,
    ) -> Option<ResidualModel> {
        let (order, _) = self.strongest_and_others(screen, regular);
        let most = order.first().map_or(0.0, |c| screen.seen[*c].gain);
        if !self.is_large(at, most) {
            return None;
        }
        let enough = self.left_by_rivals(self.refitted_alone(at)?, contacts);
        let refits = order
            .iter()
            .filter_map(|c| self.refitted_below(at, &regular[*c], screen.seen[*c].size, enough));
        let best = refits.min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        Some(ResidualModel {
            beyond_noise: far_less_beyond(
                &best.model,
                &self.training,
                self.used,
                self.rules().less_beyond,
            )?,
            ..at.residual_model.clone()
        })
    }

    /// Places of the catalogue's effects whose scores are largest, the largest first, and of all others.
    fn strongest_and_others(
        &self,
        screen: &RunScreen,
        regular: &[Candidate<Amplitude>],
    ) -> (Vec<usize>, Vec<usize>) {
        let named = (0..regular.len()).filter(|c| !regular[*c].is_column());
        let (mut order, mut others): (Vec<usize>, Vec<usize>) =
            named.partition(|c| screen.seen[*c].usable);
        order.sort_by(|a, b| screen.seen[*b].gain.total_cmp(&screen.seen[*a].gain));
        others.extend(order.split_off(order.len().min(self.rules().leaders)));
        (order, others)
    }

    /// Where something is large, or the installation is implausibly far off, the effect of the catalogue that leaves less, in a full refit
    /// with which what the installation is off by is found anew, than the selected effect and all others whose scores are large, and is significant
    /// run by run, selected, with what it explains in units of the noise's variance; `None` where that is the selected effect, or something small, or
    /// where all are far below `contacts`, the gain up to which those that were found would be selected (0 where none were).
    pub fn leading(
        &self,
        at: &Current,
        screen: &RunScreen,
        regular: &[Candidate<Amplitude>],
        selection: Option<&Selection<Amplitude>>,
        (options, contacts): (&ScreenOptions, f64),
    ) -> Option<(Selection<Amplitude>, f64)> {
        let (order, others) = self.strongest_and_others(screen, regular);
        let most = order.first().map_or(0.0, |c| screen.seen[*c].gain);
        let no_model = selection.is_some_and(|c| c.candidate.act.carrier.is_some());
        let strange = self.is_beyond_belief(at.residual_model);
        if no_model || self.least_p() > options.alpha {
            return None;
        }
        if let Some(found) = self.instead_of_clocks(at, screen, regular, (options, contacts)) {
            return Some(found);
        }
        if !(strange || self.is_large(at, most)) {
            return None;
        }
        let without = self.refitted_alone(at)?;
        let bare = self.misfit_by_run(without);
        let enough = self.left_by_rivals(without, contacts);
        let leader = |c: usize, refit: Arc<Refit>| Leader {
            candidate: &regular[c],
            at: c,
            gains: self.gains(&refit, &bare),
            refit,
        };
        let first = order.iter().filter_map(|c| {
            let refit = self.refitted_below(at, &regular[*c], screen.seen[*c].size, enough)?;
            Some(leader(*c, refit))
        });
        let mut leaders: Vec<Leader> = first.collect();
        if !strange && !leaders.iter().any(|l| self.is_large(at, total(&l.gains))) {
            return None;
        }
        // What changes the reading of a sensor moves every force at once: at the bent base its score may say nothing.
        for c in others {
            if !regular[c].act.moves_signals() {
                continue;
            }
            leaders.sort_by(|a, b| a.refit.misfit.total_cmp(&b.refit.misfit));
            let last = leaders.get(self.rules().finalists - 1);
            let beat = last.map_or(enough, |last| last.refit.misfit);
            let refit = self.refitted_below(at, &regular[c], screen.seen[c].size, beat);
            leaders.extend(refit.map(|refit| leader(c, refit)));
        }
        let explained = leaders.iter().map(|leader| total(&leader.gains));
        if explained.fold(0.0, f64::max) < self.rules().leads * contacts {
            return None;
        }
        // With an installation that was found without them all resemble one another: of those that lead, by their scores or as they are refitted,
        // and of the selected effect, it is found anew, and retained where that leaves less: found to first order it may leave more.
        let selected = selection.and_then(|c| self.refitted_at(at, &c.candidate, c.size));
        let bare = self.misfit_by_run(&self.best_installed(without));
        leaders.sort_by(|a, b| a.refit.misfit.total_cmp(&b.refit.misfit));
        for (place, leader) in leaders.iter_mut().enumerate() {
            let seen = &screen.seen[leader.at];
            let significant = seen.usable && seen.gain >= self.rules().leads * most;
            let leads = significant || place < self.rules().finalists;
            let found = leads.then(|| self.best_installed(&leader.refit));
            if let Some(refit) = found.and_then(|refit| refit.sized(leader.candidate)) {
                leader.refit = Arc::new(refit);
            }
            leader.gains = self.gains(&leader.refit, &bare);
        }
        let (place, best) = leaders
            .iter()
            .enumerate()
            .max_by(|a, b| total(&a.1.gains).total_cmp(&total(&b.1.gains)))?;
        let gain = total(&best.gains);
        let of_claim = selected.map(|refit| self.best_installed(&refit));
        if of_claim.is_some_and(|refit| total(&self.gains(&refit, &bare)) >= gain) {
            return None;
        }
        let gains: Vec<&[f64]> = leaders.iter().map(|leader| &*leader.gains).collect();
        let p_value = chances_of_gains(&gains, options.flips, options.seed)[place];
        let selection = || self.claim_of(at, screen, &leaders, best, (gain, p_value));
        (p_value <= options.alpha).then(|| (selection(), gain))
    }

    /// What a rival of contacts leaves at most, `without` being what remains without both: what explains far less than they do is given up
    /// on the way. Without any, anything is one.
    fn left_by_rivals(&self, without: &Refit, contacts: f64) -> f64 {
        match contacts > 0.0 {
            true => without.misfit - 0.5 * self.rules().leads * contacts,
            false => f64::INFINITY,
        }
    }

    /// What a refit explains of what remains without it, by run, in units of the noise's variance.
    pub fn gains(&self, refit: &Refit, bare: &[f64]) -> Vec<f64> {
        let with = self.misfit_by_run(refit);
        bare.iter().zip(&with).map(|(b, w)| 2.0 * (b - w)).collect()
    }

    /// Whether a part of a model's installation is off by more than its tolerance can mean: then it represents something that has a name.
    /// Where the noise is not what it is said to be a part may represent that.
    pub fn is_beyond_belief(&self, model: &ResidualModel) -> bool {
        self.data.noise_from != NoiseFrom::Doubted
            && model.installation.is_beyond(self.rules().belief)
    }

    /// A model whose installation is off by what its tolerances can mean and no more, its base refitted with that.
    fn within_belief(&self, model: &ResidualModel) -> Option<ResidualModel> {
        self.refitted_beside_installation(model, model.installation.within(self.rules().belief))
    }

    /// A model as it is, or within belief where it is not.
    pub fn as_believed(&self, model: &ResidualModel) -> Option<ResidualModel> {
        match self.is_beyond_belief(model) {
            true => self.within_belief(model),
            false => Some(model.clone()),
        }
    }

    /// A model with clocks as they are stated, its base refitted with that.
    pub fn with_stated_clocks(&self, model: &ResidualModel) -> Option<ResidualModel> {
        self.refitted_beside_installation(model, model.installation.with_stated_clocks())
    }

    fn refitted_beside_installation(
        &self,
        model: &ResidualModel,
        installation: Installation,
    ) -> Option<ResidualModel> {
        let changed = ResidualModel {
            installation,
            ..model.clone()
        };
        let fit = self.least_squares(&changed, Vec::new()).ok()?;
        Some(fit.residual_model)
    }

    /// The chance of what the best of some leaders explains where only sessions are independent.
    fn gains_by_sessions(&self, leaders: &[Leader], best: &Leader) -> Option<f64> {
        let place = leaders.iter().position(|leader| leader.at == best.at)?;
        let runs = best.gains.len();
        let gains = DMatrix::from_fn(leaders.len(), runs, |k, run| leaders[k].gains[run]);
        let none = DMatrix::zeros(leaders.len(), 0);
        let p_values = self.p_sessions(&gains, &vec![0.0; leaders.len()], &none)?;
        p_values.get(place).copied()
    }

    /// p-values of candidates by their scores where only sessions are independent; `None` with a single session.
    pub fn p_sessions(
        &self,
        u: &DMatrix<f64>,
        shared: &[f64],
        common: &DMatrix<f64>,
    ) -> Option<Vec<f64>> {
        let sessions = session_numbers(self.training.iter().map(|frame| frame.session.as_str()));
        let draws = (self.options.flips, self.options.seed);
        by_sessions(u, shared, common, &sessions, draws)
    }

    /// The best of some leaders, selected: those that explain no less are its class.
    pub fn claim_of(
        &self,
        at: &Current,
        screen: &RunScreen,
        leaders: &[Leader],
        best: &Leader,
        (gain, p_value): (f64, f64),
    ) -> Selection<Amplitude> {
        let alike = self.rules().laws.alike;
        let (candidate, size) = (best.candidate, best.refit.size);
        let mut class = vec![candidate.effect.clone()];
        let mut rivals = Vec::new();
        for other in leaders
            .iter()
            .filter(|l| l.candidate.effect != candidate.effect)
        {
            let [less, error] = difference(&best.gains, &other.gains);
            let in_class = less <= alike * error;
            if in_class && !class.contains(&other.candidate.effect) {
                class.push(other.candidate.effect.clone());
            }
            rivals.push(Rival {
                effect: other.candidate.effect.clone(),
                parameter: other.candidate.key.clone(),
                size: other.refit.size,
                unit: other.candidate.unit.clone(),
                t: screen.seen[other.at].t,
                gain: total(&other.gains),
                correlation: screen.correlation(best.at, other.at),
                t_of_named_beyond: less.max(0.0).sqrt(),
                in_class,
                decides: other.candidate.decides.clone(),
            });
        }
        let channel = self.strongest_channel(at.residual_model, candidate, size);
        Selection {
            place: self.place_of(candidate, at),
            channel: CHANNEL_NAMES[channel],
            size,
            error: size.abs() / gain.max(1e-300).sqrt(),
            class,
            rivals,
            p_value,
            randomised: Randomised {
                runs: Some(p_value),
                sessions: self.gains_by_sessions(leaders, best),
            },
            remark: None,
            parameters: Vec::new(),
            candidate: candidate.clone(),
        }
    }
}
