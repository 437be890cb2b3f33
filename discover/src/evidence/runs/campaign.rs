//! Recorded runs, a part of them held out, and the model that they are judged against.

use kufe_sled::Model;

use crate::error::Error;
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::catalogue::Candidates;
use crate::evidence::runs::contacts::found::Found;
use crate::evidence::runs::fit::estimate::{Estimate, Estimated, FittedRows, estimate};
use crate::evidence::runs::fit::gauss_newton::{conditional_residuals, fit, residuals};
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::residual_model::{CHANNELS, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::noise::sensors::NoiseFrom;
use crate::evidence::runs::recordings::prepare::Data;
use crate::evidence::runs::screen::track::on_track::Surveyed;
use crate::options::Options;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Selection};
use crate::procedure::rules::RunRules;
use crate::procedure::shared_effects::Chance;

/// Effects that change what sensors read: names and parameters.
pub type SensorEffects = Vec<(String, Vec<f64>)>;

/// A campaign of runs.
pub struct Campaign<'a> {
    /// The runs as they are read.
    pub data: &'a Data,
    /// The model.
    pub model: &'a Model,
    /// How the search is made.
    pub options: &'a Options,
    /// Runs to learn from.
    pub training: Vec<Frame>,
    /// Runs to learn from with what they say beneath contacts; empty where there are none.
    pub whole: Vec<Frame>,
    /// Contacts that the last screen selected.
    pub selected_contacts: Option<Found>,
    /// The track channel, and the effects on sensors with which it is so.
    pub survey: Option<(SensorEffects, Option<Surveyed>)>,
    /// The effect of the catalogue that a law was selected instead of, by first-order scores.
    pub runner_up: Option<Selection<Amplitude>>,
    /// Runs that are held out.
    pub held_out: Vec<Frame>,
    /// Channels that take part.
    pub used: [bool; CHANNELS],
    /// What may be missing.
    pub candidates: Candidates,
    /// Base parameters that the data can move.
    pub free: Vec<usize>,
    /// The model before anything is fitted.
    pub given: ResidualModel,
    /// What a reader should know of tables that do not span every sample.
    pub outside: Vec<String>,
    /// What the forces alone say of each candidate's size, with its standard error.
    pub by_forces: Vec<(Candidate<Amplitude>, f64, f64)>,
    /// What the last screen shows of the effects that other kinds of data may know, too.
    pub chances: Vec<Chance>,
}

/// A dependence on a column that no simulation knows.
#[derive(Clone)]
pub struct Unwritten {
    /// Its step.
    pub step: usize,
    /// How it acts.
    pub candidate: Candidate<Amplitude>,
    /// Its size, to first order.
    pub size: f64,
    /// Standard error of the size.
    pub error: f64,
}

/// The model with its effects, fitted.
#[derive(Clone)]
pub struct RunFit {
    /// The model.
    pub residual_model: ResidualModel,
    /// Its rows' whitening.
    pub whitener: Whitener,
    /// The step of each effect that was added.
    pub owners: Vec<usize>,
    /// What is reported, not written.
    pub unwritten: Option<Unwritten>,
    /// What remains of noisy inputs taken off, at the end: base multipliers, amplitudes, installation.
    pub estimates: Vec<Estimate>,
    /// The model that held-out runs are compared with, as they were recorded.
    pub settled: ResidualModel,
    /// The model of the sled itself rather than of what its sensors recorded, where their errors are estimated.
    pub written: Option<ResidualModel>,
}

impl RunFit {
    /// A model as it is fitted, nothing reported and nothing estimated yet.
    pub fn new(residual_model: ResidualModel, whitener: Whitener, owners: Vec<usize>) -> Self {
        Self {
            settled: residual_model.clone(),
            residual_model,
            whitener,
            owners,
            unwritten: None,
            estimates: Vec::new(),
            written: None,
        }
    }

    /// Number of effects that the model had from the start.
    pub fn already(&self) -> usize {
        self.residual_model.effects.active.len() - self.owners.len()
    }
}

/// A model and what is made for a screen of it.
pub struct Current<'a> {
    /// The model so far.
    pub residual_model: &'a ResidualModel,
    /// Its rows' whitening.
    pub whitener: &'a Whitener,
    /// Base parameters that the data can move.
    pub free: &'a [usize],
    /// Simulates runs with it.
    pub simulator: &'a RunSimulator,
}

/// Pairs of twins behind each Newton step where an installation may be off: what they leave in doubt, 7 % of what is taken off, is less
/// than the noise itself is known by.
pub const BESIDE_INSTALLATION: [u64; 2] = [1, 2];
/// Pairs of twins with which an installation is found.
pub const INSTALLATION_PAIRS: u64 = 2;

impl<'a> Current<'a> {
    /// Of a model with its rows' whitening.
    pub fn new(
        residual_model: &'a ResidualModel,
        whitener: &'a Whitener,
        free: &'a [usize],
        simulator: &'a RunSimulator,
    ) -> Self {
        Self {
            residual_model,
            whitener,
            free,
            simulator,
        }
    }

    /// Its rows' derivatives for candidates that act everywhere.
    pub fn design(&self, candidates: &'a [Candidate<Amplitude>]) -> Design<'a> {
        Design {
            residual_model: self.residual_model,
            whitener: self.whitener,
            free_base: self.free,
            candidates,
            local: &[],
            windows: &[],
        }
    }
}

impl Campaign<'_> {
    /// Simulates training runs with a model.
    pub fn simulator(&self, residual_model: &ResidualModel) -> RunSimulator {
        RunSimulator::new(
            &self.training,
            residual_model,
            self.data.noise,
            self.used,
            (self.options.seed, self.rules()),
        )
    }

    /// The whitening of what a model leaves of the training runs given its discrepancy.
    pub fn whitener(&self, model: &ResidualModel) -> Whitener {
        Whitener::estimate(&conditional_residuals(model, &self.training), self.used)
    }

    /// The rules of runs.
    pub fn rules(&self) -> &RunRules {
        &self.options.rules.runs
    }

    /// The smallest p-value that sign-flips of the training runs can give: `2^(1 - R)`.
    pub fn least_p(&self) -> f64 {
        2.0_f64.powi(1 - i32::try_from(self.training.len()).unwrap_or(i32::MAX))
    }

    /// What the training runs are too few for, in a sentence; `None` where they can carry every kind of effect.
    pub fn too_few(&self) -> Option<String> {
        let (rules, least) = (self.rules(), self.least_p());
        let alpha = rules.alpha;
        let (what, limit) = match () {
            () if least > alpha => ("an effect within runs", alpha),
            () if least > rules.alpha_column => {
                ("a column outside the catalogue", rules.alpha_column)
            }
            () => return None,
        };
        let needed = (1.0 - limit.log2()).ceil();
        Some(format!(
            "with {} runs to learn from no p-value by sign-flips can be below {least:.1e}; {what} must reach {limit}, so that only what exceeds the tolerances by itself can be selected: {needed} runs are needed in addition to the held-out ones",
            self.training.len()
        ))
    }

    /// After a first name the next ones are limited to half of the chance of an error.
    pub fn share(&self, account: &Account) -> f64 {
        match account.steps.is_empty() {
            true => 1.0,
            false => self.rules().alpha_again,
        }
    }

    /// Fits base and effects, and with them what the installation is off by and the discrepancy.
    ///
    /// # Errors
    /// [`Error::BaseFit`] where a residual is not finite.
    pub fn fitted(
        &self,
        residual_model: &ResidualModel,
        owners: Vec<usize>,
    ) -> Result<RunFit, Error> {
        let plain = self.least_squares(residual_model, owners)?;
        let random = residual_model.discrepancy.count();
        if residual_model.installation.directions.is_empty() && random == 0 {
            return Ok(plain);
        }
        // By corrected scores: least squares would shrink what scales the residual's own noise.
        let at = &plain.residual_model.hold(false);
        let off = self
            .newton(at, &plain.whitener, &[INSTALLATION_PAIRS], true)
            .model;
        self.with_installation(plain, &off)
    }

    /// A fit given what its installation is found to be off by; without that where it makes the rows worse by more than it costs: a step
    /// along what the data hardly tell has gone too far.
    pub fn with_installation(&self, plain: RunFit, off: &ResidualModel) -> Result<RunFit, Error> {
        // Of a base that runs away the installation is none of this sled's.
        if !self.free.iter().all(|b| off.within(*b)) {
            return Ok(plain);
        }
        let found = self.least_squares(off, plain.owners.clone())?;
        let cost = found.residual_model.installation.distance();
        let misfit = |fit: &RunFit| self.misfit(&fit.residual_model, &fit.whitener);
        let worse = misfit(&found) - misfit(&plain);
        Ok(if worse > cost { plain } else { found })
    }

    /// Fits base and effects alone, with an installation as it is. Base parameters that run to a bound, as they do where what is
    /// missing bends the base, stay as they are given: from a bound no later refit finds back.
    ///
    /// # Errors
    /// As [`fitted`](Self::fitted).
    pub fn least_squares(
        &self,
        residual_model: &ResidualModel,
        owners: Vec<usize>,
    ) -> Result<RunFit, Error> {
        let fixed = residual_model.hold(true);
        let fitted =
            |model: &ResidualModel, free: &[usize]| fit(model, &self.training, free, self.used);
        let mut found = fitted(&fixed, &self.free)?;
        let free = self.free.iter().copied();
        let inside: Vec<usize> = free.filter(|b| found.model.within(*b)).collect();
        if inside.len() < self.free.len() {
            let again = ResidualModel {
                base: self.given.base,
                ..fixed
            };
            found = fitted(&again, &inside)?;
        }
        Ok(RunFit::new(found.model, found.whitener, owners))
    }

    /// Estimates of a fit.
    pub fn estimates(&self, residual_model: &ResidualModel, whitener: &Whitener) -> Estimated {
        // An installation makes many columns, and its errors are known by no more than their tolerance.
        let pairs: &[u64] = match residual_model.installation.fitted() {
            0 => &[1, 4, 16],
            _ => &BESIDE_INSTALLATION,
        };
        self.newton(residual_model, whitener, pairs, self.settles())
    }

    /// Whether the noise's bias is known well enough to be taken off.
    pub fn settles(&self) -> bool {
        self.data.noise_from != NoiseFrom::Differences
    }

    /// Newton steps on corrected scores, by so many pairs of twins each.
    pub fn newton(
        &self,
        residual_model: &ResidualModel,
        whitener: &Whitener,
        pairs: &[u64],
        settle: bool,
    ) -> Estimated {
        let trust = match self.data.noise_from {
            NoiseFrom::Model => self.rules().stated_noise_error,
            _ => self.rules().estimated_noise_error,
        };
        let simulator = self.simulator(residual_model);
        let rows = FittedRows {
            residual_model,
            whitener,
            frames: &self.training,
            free: &self.free,
            simulator: &simulator,
        };
        estimate(&rows, pairs, trust, settle)
    }

    /// Candidates that are not already part of the model.
    pub fn fresh(
        &self,
        residual_model: &ResidualModel,
        list: &[Candidate<Amplitude>],
    ) -> Vec<Candidate<Amplitude>> {
        let active = &residual_model.effects.active;
        let on = |c: &Candidate<Amplitude>| {
            active.iter().any(|e| {
                e.effect_name() == c.effect
                    && e.track == c.act.track
                    && e.values[c.act.parameter] != 0.0
            })
        };
        list.iter().filter(|c| !on(c)).cloned().collect()
    }
}

/// Root mean square of rows.
pub fn scale_of(rows: &[f64]) -> f64 {
    (rows.iter().map(|x| x * x).sum::<f64>() / rows.len().max(1) as f64)
        .sqrt()
        .max(1e-300)
}

/// Root mean square of one channel over all runs.
pub fn gap_of(residual_model: &ResidualModel, frames: &[Frame], channel: usize) -> f64 {
    let rows: Vec<f64> = residuals(residual_model, frames)
        .into_iter()
        .flat_map(|r| r[channel].clone())
        .collect();
    scale_of(&rows)
}
