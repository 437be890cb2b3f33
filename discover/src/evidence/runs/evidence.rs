//! Runs as evidence.

use std::sync::Mutex;

use kufe_sled::effects::{CATALOGUE, Effects, Kind, Level};
use kufe_sled::{Model, Vehicle, refuse_effects};

use crate::error::{Error, Result};
use crate::evidence::runs::campaign::{Campaign, Current, RunFit, UnwrittenEffect, channel_rms};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::catalogue::list;
use crate::evidence::runs::channels::{channels_in_use, outside, remarks_on_channels};
use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::fit::gauss_newton::free_base;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::residual_model::{BASE, CHANNEL_NAMES, ResidualModel};
use crate::evidence::runs::outcome::bins::significant_bins;
use crate::evidence::runs::outcome::conclude::shared_faults;
use crate::evidence::runs::outcome::next_model::next_model;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::noise::sensors::NoiseFrom;
use crate::evidence::runs::recordings::prepare::Data;
use crate::finding::{HeldOut, Report, Step};
use crate::options::Options;
use crate::procedure::evidence::{
    Account, Choice, Description, Evidence, ExtendedFit, HeldOutResults, Meaning, Screen,
    SelectedFit, Selection,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::search::{Found, search_evidence};

impl<'a> Campaign<'a> {
    /// Holds out a part of the runs and determines the channels in use.
    ///
    /// # Errors
    /// [`Error::TooFew`] for fewer than two runs or segments to train on, [`Error::Effect`].
    pub fn new(data: &'a Data, model: &'a Model, options: &'a Options) -> Result<Self> {
        let mut own = Effects::from_tables(&model.effects)?;
        let contacts = Contacts::given(&mut own.active);
        let trial = own.clone();
        // A custom effect of value 0 is a candidate, not a part of the model.
        own.active
            .retain(|e| !(matches!(e.kind, Kind::Custom(_)) && e.values[0] == 0.0));
        for frame in &data.frames {
            refuse_effects(
                &own,
                &frame.unstated_conditions(),
                &format!("run {}", frame.name),
            )?;
        }
        let given = ResidualModel::new(Vehicle::new(model)?, [1.0; BASE], own);
        for frame in &data.frames {
            let stated = !frame.unstated_conditions().contains(&"ice_c");
            given
                .vehicle
                .refuse_unstated_ice(stated, &format!("run {}", frame.name))?;
        }
        let locked = &data.locked;
        let sensors = RunSimulator::of_sensors(data.noise, (options.seed, &options.rules.runs));
        let frames = sensors.with_row_noise(&data.frames);
        let pick =
            |which: &[usize]| -> Vec<Frame> { which.iter().map(|i| frames[*i].clone()).collect() };
        let (training, held_out) = (pick(&locked.training), pick(&locked.held_out));
        if training.len() < 2 {
            return Err(Error::TooFew {
                what: "training runs, in addition to the held-out ones".to_owned(),
                found: training.len(),
                needed: 2,
            });
        }
        let outside = outside(&given, &data.frames);
        let used = channels_in_use(data, model, options);
        let mut campaign = Self {
            data,
            model,
            options,
            free: free_base(&given, &training, used),
            training,
            held_out,
            used,
            candidates: list(data, &trial, used[0], options),
            given,
            outside,
            by_forces: Vec::new(),
            screen_estimates: Vec::new(),
            whole: Vec::new(),
            selected_contacts: None,
            survey: None,
            replay_inputs: Mutex::default(),
            installed: Mutex::default(),
            runner_up: None,
        };
        if let Some(contacts) = contacts {
            campaign.given_contacts(contacts);
        }
        Ok(campaign)
    }
}

impl Evidence for Campaign<'_> {
    type Act = Amplitude;
    type Fit = RunFit;

    fn fit_base(&mut self, account: &mut Account) -> Result<RunFit> {
        account.remarks.extend(self.options.restriction_remark());
        account.remarks.extend(self.too_few());
        let remarks = self.data.remarks.iter().chain(&self.outside);
        account.remarks.extend(remarks.cloned());
        account
            .remarks
            .extend(remarks_on_channels(self.model, self.used[0]));
        let start = self.started(&self.given)?;
        let rough = self.roughly_fitted(&self.with_discrepancy(start.clone()))?;
        let rough = if self.mark_pushes(&rough.with_fixed(true), account) {
            self.roughly_fitted(&rough)?
        } else {
            rough
        };
        self.scale_places(&rough);
        let start = self.roughly_fitted(&start)?;
        let base = self.fitted(&self.with_discrepancy(start), Vec::new())?;
        self.given.model_error = base.residual_model.model_error;
        if self.data.noise_from == NoiseFrom::Differences {
            let n = self.data.noise.sd();
            account.remarks.push(format!(
                "no [noise] in the model: estimated from the signals: accelerometer {:.3} m/s2, rates {:.5} rad/s, speed {:.4} m/s, slip {:.6} rad, steering {:.6} rad, roll split {:.6} rad",
                n.accel_mps2, n.rate_radps, n.speed_mps, n.slip_rad, n.steer_rad, n.roll_split_rad
            ));
        }
        Ok(base)
    }

    fn screen(&mut self, fit: &RunFit, account: &mut Account) -> Result<Screen<Amplitude>> {
        self.runner_up = None;
        let residual_model = &fit.residual_model.with_fixed(false);
        let whitener = self.whitener(residual_model);
        let simulator = self.simulator(residual_model);
        let free = self.free.clone();
        let at = Current::new(residual_model, &whitener, &free, &simulator, self.form());
        let track = self.surveyed(residual_model, &simulator, account);
        if let Some(track) = track.as_ref().filter(|track| self.is_tilted(track)) {
            self.by_forces.clear();
            if let Some(selection) = self.on_the_track(residual_model, track, account) {
                return Ok(Screen {
                    selection: Some(selection),
                    detectable: Vec::new(),
                });
            }
        }
        let mut screen = self.within_runs(&at, track.as_ref(), account);
        if screen.selection.is_none() {
            let (selection, screen_estimates) = self.between_runs(&at, account);
            screen.selection = selection;
            self.screen_estimates.extend(screen_estimates);
        }
        if let (None, Some(track)) = (&screen.selection, &track) {
            screen.selection = self.on_the_track(residual_model, track, account);
        }
        Ok(screen)
    }

    fn add(
        &mut self,
        fit: &RunFit,
        selection: &Selection<Amplitude>,
        step: usize,
    ) -> Result<ExtendedFit<RunFit>> {
        if let Some(found) = self.selected_contacts.take() {
            return self.add_contacts(fit, found, step);
        }
        let residual_model = &fit.residual_model;
        let channel = CHANNEL_NAMES.iter().position(|c| *c == selection.channel);
        let rms = |residual_model: &ResidualModel| {
            channel_rms(residual_model, &self.training, channel.unwrap_or(1))
        };
        let before = rms(residual_model);
        if selection.candidate.act.carrier.is_some() {
            let mut next = fit.clone();
            next.unwritten = Some(UnwrittenEffect {
                step,
                candidate: selection.candidate.clone(),
                size: selection.size,
                error: selection.error,
            });
            return Ok(ExtendedFit {
                fit: next,
                is_writable: false,
                rms: [before, before],
                place: None,
            });
        }
        let mut active = selection.candidate.active(selection.size);
        let known = residual_model.effects.active.iter();
        let same = known.filter(|e| e.effect_name() == active.name).count();
        if same > 0 {
            active.name = format!("{}@{}", active.name, same + 1);
        }
        let mut next = residual_model.with(active.clone());
        if !selection.parameters.is_empty() {
            next.frozen.push(active.name);
        }
        let owners = fit.owners.iter().copied().chain([step]).collect();
        // A large effect biases the base and conceals installation errors: both are estimated anew.
        let next = self.fitted_anew(&next, owners)?;
        let stretch = selection.candidate.act.track.is_some();
        Ok(ExtendedFit {
            rms: [before, rms(&next.residual_model)],
            place: stretch.then(|| selection.place.clone()),
            fit: next,
            is_writable: true,
        })
    }

    fn exchange(
        &mut self,
        before: &RunFit,
        (selection, added): SelectedFit<Amplitude, RunFit>,
        step: usize,
        account: &Account,
    ) -> Result<SelectedFit<Amplitude, RunFit>> {
        // The track channel, levels of runs and sessions, and contacts have their own screens.
        let within = selection.candidate.act.level == Level::Sample
            && selection.parameters.is_empty()
            && added.is_writable;
        if within {
            self.exchanged(before, (selection, added), step, account)
        } else {
            Ok((selection, added))
        }
    }

    fn remove_superfluous(&mut self, fit: RunFit, account: &mut Account) -> Result<RunFit> {
        self.with_significant_steps(fit, account)
    }

    fn without(&mut self, fit: &RunFit, step: usize) -> Result<RunFit> {
        self.without_step(fit, step)
    }

    fn misfit_decrease(&self, from: &RunFit, to: &RunFit) -> Result<Option<Decrease>> {
        Ok(self.held_out_decrease(from, to))
    }

    fn compare(&mut self, base: &RunFit, last: &RunFit, steps: &[Step]) -> Result<HeldOutResults> {
        let in_these = |model| self.installed_in(model, &self.held_out);
        let [given, last_model] = [&self.given_as_in(last), &last.final_model].map(in_these);
        let simulator = self.simulator(&last.final_model);
        let channels = self.channel_gaps(&given, &last_model, &self.held_out, &simulator);
        let first = steps.first();
        let shown = first.map_or(CHANNEL_NAMES[1].0, |step| step.channel.as_str());
        let one = channels.iter().find(|c| c.channel == shown);
        let one = one.or(channels.first());
        Ok(HeldOutResults {
            held_out: HeldOut {
                what: if self.data.segmented {
                    "segment".to_owned()
                } else {
                    "run".to_owned()
                },
                runs: self.held_out.iter().map(|f| f.name.clone()).collect(),
                gap_before: one.map_or(0.0, |c| c.before),
                gap_after: one.map_or(0.0, |c| c.after),
                unit: one.map_or(String::new(), |c| c.unit.clone()),
                channels,
            },
            closed: self.closed_shares(base, last, steps),
        })
    }

    fn choose(
        &mut self,
        refitted: &RunFit,
        last: RunFit,
        account: &mut Account,
    ) -> Result<Choice<RunFit>> {
        self.chosen(refitted, last, account)
    }

    fn describe(
        &mut self,
        base: &RunFit,
        last: &RunFit,
        account: &mut Account,
    ) -> Result<Description> {
        let next_runs = if self.options.quick {
            Vec::new()
        } else {
            self.next_runs(last, &account.steps)?
        };
        let simulator = self.simulator(&last.final_model);
        let rules = &self.options.rules.runs;
        let bins = |fit: &RunFit| significant_bins(fit, &self.training, self.options.seed);
        let bins_after = bins(last);
        let faults = shared_faults(&account.steps, &self.training, rules.alpha);
        account.depends.extend(faults);
        self.describe_contacts(last, &mut account.steps);
        let base_parameters = self.base_parameters(last);
        let data = if self.data.segmented {
            "one run, in segments"
        } else {
            "runs"
        };
        let given = self.installed_in(&self.given_as_in(last), self.whole());
        let training = self.channel_gaps(&given, &last.final_model, self.whole(), &simulator);
        // With coloured or misstated noise bins are significant, too.
        let is_noise_stated = !matches!(
            self.data.noise_from,
            NoiseFrom::Doubted | NoiseFrom::Spectra
        );
        Ok(Description {
            located: account.steps.is_empty()
                && is_noise_stated
                && self.has_significant_bins(last, &bins_after),
            report: Report {
                data: data.to_owned(),
                remaining: self.remaining(base, last),
                pictures: [
                    self.pictures(last, &account.steps, &training, &given),
                    self.contact_pictures(last),
                ]
                .concat(),
                training,
                within_tolerance: self.within_tolerance(last, account),
                session_offsets: self.session_offsets(last, account),
                implausible: self.implausible(&base_parameters, account),
                base: base_parameters,
                bins: bins(base),
                clean: bins_after.iter().all(|b| b.p_value > rules.bin_unclean),
                bins_after,
                by_run: self.by_run(&base.residual_model, &last.residual_model),
                untestable: self.candidates.untestable.clone(),
                next_runs,
                ..Report::default()
            },
            parameters: self.parameters(last, account.steps.len()),
            laws: self.laws(last, account.steps.len()),
            effects: CATALOGUE.iter().map(|e| Meaning::of(e.info())).collect(),
            nothing: self
                .too_few()
                .filter(|_| self.least_p() > rules.alpha)
                .map_or(String::new(), |few| {
                    format!("Too few runs to find what acts within them: {few}.")
                }),
            next_after_nothing: self.runs_to_halve(),
            next_model: next_model(self.model, &last.final_model, last.already()).to_toml(),
            next_case: None,
        })
    }
}

/// Searches runs for missing effects.
///
/// # Errors
/// [`Error::TooFew`] for fewer than two runs or segments to train on, [`Error::BaseFit`],
/// [`Error::Effect`].
pub fn search(
    data: &Data,
    model: &Model,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found> {
    options.check_names(Some(model))?;
    let mut campaign = Campaign::new(data, model, options)?;
    let mut found = search_evidence(&mut campaign, options, progress)?;
    found.report.gaps.clone_from(&data.gaps);
    Ok(found)
}
