//! Recorded runs, a part of them held out, and the model that they are compared with.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};

use kufe_sled::effects::Effects;
use kufe_sled::{Inputs, Model};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::catalogue::Candidates;
use crate::evidence::runs::contacts::selection::FoundContacts;
use crate::evidence::runs::fit::estimate::Estimate;
use crate::evidence::runs::fit::gauss_newton::{conditional_residuals, residuals};
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::discrepancy::Discrepancy;
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::{CHANNELS, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::place_scales::PlaceScales;
use crate::evidence::runs::recordings::prepare::Data;
use crate::evidence::runs::screen::track::on_track::SurveyedTrack;
use crate::options::Options;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Selection};
use crate::procedure::rules::RunRules;
use crate::procedure::shared_effects::ScreenEstimate;

/// Effects on sensors: names and parameters.
pub type SensorEffects = Vec<(String, Vec<f64>)>;

/// The effects on sensors among these.
pub fn sensor_effects(effects: &Effects) -> SensorEffects {
    let on_sensors = effects.active.iter().filter(|e| e.moves_signals());
    on_sensors
        .map(|e| (e.name.clone(), e.values.clone()))
        .collect()
}

/// A cache, locked.
pub fn locked<T>(cache: &Mutex<T>) -> MutexGuard<'_, T> {
    cache
        .lock()
        .expect("no thread panics while it has the lock")
}

/// A campaign of runs.
pub struct Campaign<'a> {
    pub data: &'a Data,
    pub model: &'a Model,
    pub options: &'a Options,
    pub training: Vec<Frame>,
    /// Training runs with the samples during contacts; empty if there are no contacts.
    pub whole: Vec<Frame>,
    /// Contacts that the last screen selected.
    pub selected_contacts: Option<FoundContacts>,
    /// The cached track channel, and the effects on sensors that it was computed with.
    pub survey: Option<(SensorEffects, Option<SurveyedTrack>)>,
    /// Cached installation errors and discrepancy of runs, by the names of the runs and the model.
    pub installed: Mutex<HashMap<String, (Installation, Discrepancy)>>,
    /// Cached inputs of each run's replay, and the effects on sensors that they were corrected
    /// with.
    pub replay_inputs: Mutex<HashMap<usize, (SensorEffects, Arc<Inputs>)>>,
    /// The effect of the catalogue that a law was preferred to by first-order scores.
    pub runner_up: Option<Selection<Amplitude>>,
    pub held_out: Vec<Frame>,
    pub used: [bool; CHANNELS],
    pub candidates: Candidates,
    /// Base parameters that the data can determine.
    pub free: Vec<usize>,
    /// The model before any fit.
    pub given: ResidualModel,
    /// Remarks on tables that do not span every sample.
    pub outside: Vec<String>,
    /// Size and standard error of each candidate by the forces alone.
    pub by_forces: Vec<(Candidate<Amplitude>, f64, f64)>,
    /// Estimates and p-values of the last screen, for other kinds of data.
    pub screen_estimates: Vec<ScreenEstimate>,
}

/// A dependence on a column that simulations do not have.
#[derive(Clone)]
pub struct UnwrittenEffect {
    pub step: usize,
    pub candidate: Candidate<Amplitude>,
    /// Its size, to first order.
    pub size: f64,
    pub error: f64,
}

/// A fitted model with its effects.
#[derive(Clone)]
pub struct RunFit {
    pub residual_model: ResidualModel,
    /// The same with the installation errors of the held-out runs, once it is compared on them.
    pub held_out: OnceLock<ResidualModel>,
    pub whitener: Whitener,
    /// The step of each added effect.
    pub owners: Vec<usize>,
    /// A dependence that is reported but not written.
    pub unwritten: Option<UnwrittenEffect>,
    /// Final corrected estimates: base multipliers, amplitudes, installation errors.
    pub estimates: Vec<Estimate>,
    /// The model of the final estimates.
    pub final_model: ResidualModel,
    /// The same with the final estimates given the base as stated.
    pub base_as_given: Option<Box<RunFit>>,
    /// For each session its training runs and the model of the final estimates without it.
    pub left_out: Vec<(Vec<usize>, ResidualModel)>,
}

impl RunFit {
    /// A fit before estimates are made.
    pub fn new(residual_model: ResidualModel, whitener: Whitener, owners: Vec<usize>) -> Self {
        Self {
            final_model: residual_model.clone(),
            residual_model,
            held_out: OnceLock::new(),
            whitener,
            owners,
            unwritten: None,
            estimates: Vec::new(),
            left_out: Vec::new(),
            base_as_given: None,
        }
    }

    /// Number of effects of the given model.
    pub fn already(&self) -> usize {
        self.residual_model.effects.active.len() - self.owners.len()
    }
}

/// A model and the quantities of its screen.
pub struct Current<'a> {
    pub residual_model: &'a ResidualModel,
    pub whitener: &'a Whitener,
    /// Base parameters that the data can determine.
    pub free: &'a [usize],
    pub simulator: &'a RunSimulator,
    /// Tolerance of the lateral laws' form.
    pub form: f64,
}

impl<'a> Current<'a> {
    pub fn new(
        residual_model: &'a ResidualModel,
        whitener: &'a Whitener,
        free: &'a [usize],
        simulator: &'a RunSimulator,
        form: f64,
    ) -> Self {
        Self {
            residual_model,
            whitener,
            free,
            simulator,
            form,
        }
    }

    /// Derivatives of its rows for candidates that act everywhere.
    pub fn design(&self, candidates: &'a [Candidate<Amplitude>]) -> Design<'a> {
        Design {
            residual_model: self.residual_model,
            whitener: self.whitener,
            free_base: self.free,
            form: self.form,
            candidates,
            local: &[],
            windows: &[],
            noise: None,
        }
    }
}

impl Campaign<'_> {
    /// Derivatives of a model's rows for candidates that act everywhere, without a tolerance of the
    /// laws' form.
    pub fn design<'d>(
        &'d self,
        residual_model: &'d ResidualModel,
        whitener: &'d Whitener,
        candidates: &'d [Candidate<Amplitude>],
    ) -> Design<'d> {
        Design {
            residual_model,
            whitener,
            free_base: &self.free,
            form: 0.0,
            candidates,
            local: &[],
            windows: &[],
            noise: None,
        }
    }

    /// A simulator of the training runs with a model.
    pub fn simulator(&self, residual_model: &ResidualModel) -> RunSimulator {
        RunSimulator::new(
            &self.training,
            residual_model,
            self.data.noise,
            self.used,
            (self.options.seed, self.rules()),
        )
    }

    /// Whitening of a model's residuals on the training runs, given its discrepancy.
    pub fn whitener(&self, model: &ResidualModel) -> Whitener {
        let residuals = conditional_residuals(model, &self.training);
        Whitener::estimate(&self.training, &residuals, self.used)
    }

    /// Divides the rows of all runs by the standard deviations of a model's residuals by place.
    pub fn scale_places(&mut self, model: &ResidualModel) {
        let residuals = conditional_residuals(model, &self.training);
        let width_m = 0.5 * self.rules().discrepancy_m;
        let scales = Arc::new(PlaceScales::estimate(&self.training, &residuals, width_m));
        let runs = self.training.iter_mut().chain(&mut self.held_out);
        for frame in runs.chain(&mut self.whole) {
            frame.scales = Some(Arc::clone(&scales));
        }
    }

    /// Tolerance of the lateral laws' form.
    pub fn form(&self) -> f64 {
        self.model.tolerances.unwrap_or_default().lateral_form
    }

    pub fn rules(&self) -> &RunRules {
        &self.options.rules.runs
    }

    /// The smallest p-value that sign-flips of the training runs can give: `2^(1 - R)`.
    pub fn least_p(&self) -> f64 {
        2.0_f64.powi(1 - i32::try_from(self.training.len()).unwrap_or(i32::MAX))
    }

    /// A remark on effects for which the training runs are too few; `None` if they suffice for all.
    pub fn too_few(&self) -> Option<String> {
        let (rules, least) = (self.rules(), self.least_p());
        let (what, limit) = if least > rules.alpha {
            ("an effect within runs", rules.alpha)
        } else if least > rules.alpha_column {
            ("a column outside the catalogue", rules.alpha_column)
        } else {
            return None;
        };
        let needed = (1.0 - limit.log2()).ceil();
        Some(format!(
            "with {} training {} no p-value by sign-flips can be below {least:.1e}; {what} must reach {limit}, so that only what exceeds the tolerances by itself can be selected: {needed} are needed in addition to the held-out ones",
            self.training.len(),
            if self.data.segmented {
                "segments"
            } else {
                "runs"
            }
        ))
    }

    /// Share of the significance level that remains after the first selected effect.
    pub fn share(&self, account: &Account) -> f64 {
        if account.steps.is_empty() {
            1.0
        } else {
            self.rules().alpha_again
        }
    }

    /// Candidates that the model does not contain.
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
pub fn channel_rms(residual_model: &ResidualModel, frames: &[Frame], channel: usize) -> f64 {
    let runs = residuals(residual_model, frames);
    let rows = runs.into_iter().flat_map(|rows| rows[channel].clone());
    let rows: Vec<f64> = rows.collect();
    scale_of(&rows)
}
