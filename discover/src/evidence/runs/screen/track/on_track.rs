//! Selection in the track channel: slope, profile, and similar errors of accelerometer and speed.

use std::f64::consts::{PI, SQRT_2};

use kufe_sled::GRAVITY;

use crate::evidence::runs::campaign::{Campaign, sensor_effects};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::installation::{Information, Installation, InstallationError};
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ResidualModel, TRACK};
use crate::evidence::runs::screen::track::channel::{ProfileDeparture, TrackChannel};
use crate::finding::{Fitted, Rival};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Dependence, Selection};
use crate::procedure::rivals::NamedEffect;

/// The track channel of a screen, if it is used.
#[derive(Clone)]
pub struct SurveyedTrack {
    channel: TrackChannel,
    /// Slope and similar sensor errors.
    list: Vec<Candidate<Amplitude>>,
    /// Standard deviation of the surveyed slope \[rad\].
    sd: f64,
    /// Largest difference of two estimates that agree, in its standard errors.
    agree_within: f64,
}

impl SurveyedTrack {
    /// Whether the channel agrees with the forces' estimate of a candidate; true for candidates
    /// that are not in the channel.
    pub fn agrees(&self, candidate: &Candidate<Amplitude>, size: f64, error: f64) -> bool {
        let mut list = self.list.iter();
        let same = list.position(|other| is_same_amplitude(other, candidate));
        same.is_none_or(|c| {
            let seen = self.channel.score(c, self.sd);
            (seen.size - size).abs() < self.agree_within * seen.error.hypot(error)
        })
    }
}

/// Whether two candidates are the same amplitude of an effect.
fn is_same_amplitude(a: &Candidate<Amplitude>, b: &Candidate<Amplitude>) -> bool {
    a.effect == b.effect && a.key == b.key
}

/// An assumption about the track's survey.
fn on_survey(assumption: String) -> Dependence {
    Dependence {
        assumption,
        decides: "a survey of the track's slope with a stated deviation".to_owned(),
    }
}

impl Campaign<'_> {
    /// Information of the track channel on installation errors; `None` without a channel, or if a
    /// slope fitted in it has already used it.
    pub fn track_information(
        &self,
        model: &ResidualModel,
        stated: &Installation,
    ) -> Option<Information> {
        if !self.used[3] || !stated.errors.iter().any(InstallationError::is_tilt) {
            return None;
        }
        let bare = ResidualModel {
            installation: stated.clone(),
            ..model.clone()
        };
        let channel = TrackChannel::new(&bare, &self.training, self.rules())?;
        let slope_sd = (self.model.survey).map_or(self.rules().slope_sd_rad, |s| s.slope_sd_rad);
        Some(channel.information(&bare, &self.training, stated, slope_sd.max(1e-6)))
    }

    /// Whether a tilt of the accelerometer exceeds its tolerance: friction depends on it, so that
    /// it is selected before effects on forces.
    pub fn is_tilted(&self, track: &SurveyedTrack) -> bool {
        let is_significant = |(c, candidate): (usize, &Candidate<Amplitude>)| {
            let seen = track.channel.score(c, track.sd);
            let tolerance = self.tolerance(candidate);
            let is_tilt = ["rad", "m/s2"].contains(&candidate.unit.as_str());
            is_tilt && seen.size.abs() > self.rules().belief * tolerance
        };
        track.list.iter().enumerate().any(is_significant)
    }

    /// The channel; `None` without a survey, if its runs disagree, or if a slope fitted in it has
    /// already used its information. It contains no force and is cached until an effect on a sensor
    /// changes.
    pub fn surveyed(
        &mut self,
        residual_model: &ResidualModel,
        simulator: &RunSimulator,
        account: &mut Account,
    ) -> Option<SurveyedTrack> {
        if !residual_model.frozen.is_empty() {
            return None;
        }
        let own = sensor_effects(&residual_model.effects);
        if let Some((_, survey)) = self.survey.as_ref().filter(|(known, _)| *known == own) {
            return survey.clone();
        }
        let survey = self.survey_of(residual_model, simulator, account);
        self.survey = Some((own, survey.clone()));
        survey
    }

    fn survey_of(
        &self,
        residual_model: &ResidualModel,
        simulator: &RunSimulator,
        account: &mut Account,
    ) -> Option<SurveyedTrack> {
        if !self.used[3] {
            return None;
        }
        let mut list = self.fresh(residual_model, &self.candidates.track);
        list.retain(|candidate| !candidate.is_profile());
        let stated = self.model.survey.map(|s| s.slope_sd_rad);
        let sd = stated.unwrap_or(self.rules().slope_sd_rad);
        // A tilt that was estimated from the channel itself would conceal its signal.
        let installation = &residual_model.installation;
        let residual_model = &ResidualModel {
            installation: installation.with_zeroed(InstallationError::is_tilt),
            ..residual_model.clone()
        };
        let mut channel = TrackChannel::new(residual_model, &self.training, self.rules())?;
        if stated.is_none() && account.steps.is_empty() {
            account.remarks.push(format!(
                "no [survey] in the model: a slope deviation of {sd} rad is assumed"
            ));
        }
        let quiet = simulator.sensors_only();
        let simulated = quiet.simulated(&self.training, residual_model, 5_000_003);
        let expected = TrackChannel::new(residual_model, &simulated, self.rules())?.scatter;
        let scatter = channel.scatter;
        if scatter > self.rules().track_agrees * expected {
            if account.steps.is_empty() {
                account.remarks.push(format!(
                    "from run to run the speed's derivative, the accelerometer and the track's slope disagree by {scatter:.3} m/s2, the sensors' noise explains {expected:.3}: the track channel is not used, and slope, track-profile and the accelerometer's pitch are not judged"
                ));
            }
            return None;
        }
        for candidate in &list {
            let known = [self.tolerance(candidate), sd];
            channel.add_candidate(residual_model, &self.training, candidate, known);
        }
        Some(SurveyedTrack {
            channel,
            list,
            sd,
            agree_within: self.options.rules.search.agree,
        })
    }

    /// Standard deviation of a candidate of the track channel due to tolerances of accelerometer
    /// and clocks, in its unit.
    fn tolerance(&self, candidate: &Candidate<Amplitude>) -> f64 {
        let known = self.model.tolerances.unwrap_or_default();
        match candidate.unit.as_str() {
            "rad" => (known.accel_bias_mps2 / GRAVITY).hypot(known.misalignment_rad),
            "m/s2" => (known.accel_bias_mps2).hypot(GRAVITY * known.misalignment_rad),
            // Delays of the speed and of the accelerometer; and relative to the slope, which is not
            // low-passed as the signals are.
            "s" => {
                let spread = 0.5 / (PI * self.rules().recordings.signal_cutoff_hz);
                (known.delay_s * SQRT_2).hypot(spread)
            }
            _ => 0.0,
        }
    }

    /// Twice the log density of a size relative to a size of 0 under its prior: Student's t of four
    /// degrees of freedom, scaled by the survey's deviation for a slope and the tolerance for a
    /// sensor; 0 without a prior.
    fn prior_penalty(&self, candidate: &Candidate<Amplitude>, size: f64, slope_sd: f64) -> f64 {
        const FREEDOM: f64 = 4.0;
        let known = self.model.tolerances.unwrap_or_default();
        let sd = match candidate.unit.as_str() {
            "rad" if candidate.effect == "slope" => slope_sd,
            "rad" => known.misalignment_rad,
            "m/s2" => known.accel_bias_mps2,
            _ => 0.0,
        };
        if sd > 0.0 {
            (FREEDOM + 1.0) * ((size / sd).powi(2) / FREEDOM).ln_1p()
        } else {
            0.0
        }
    }

    /// The selected effect in the track channel, if one is significant: a slope or a sensor error,
    /// else a departure of the profile.
    pub fn on_the_track(
        &self,
        residual_model: &ResidualModel,
        track: &SurveyedTrack,
        account: &mut Account,
    ) -> Option<Selection<Amplitude>> {
        self.slope_or_sensor(residual_model, track, account)
            .or_else(|| self.profile_departure(residual_model, track, account))
    }

    /// The candidate of the largest posterior density, if one is significant.
    fn slope_or_sensor(
        &self,
        residual_model: &ResidualModel,
        track: &SurveyedTrack,
        account: &mut Account,
    ) -> Option<Selection<Amplitude>> {
        let rules = self.rules();
        let (channel, list, sd) = (&track.channel, &track.list, track.sd);
        // A sensor error also acts on the forces: candidates that these contradict are excluded.
        let agrees = |c: &usize| {
            let mut by_forces = self.by_forces.iter();
            let same = by_forces.find(|(known, ..)| is_same_amplitude(known, &list[*c]));
            same.is_none_or(|(known, size, error)| track.agrees(known, *size, *error))
        };
        let consistent: Vec<usize> = (0..list.len()).filter(agrees).collect();
        let significant = |factor: f64| -> Vec<usize> {
            let is_significant = |c: &usize| {
                let seen = channel.score(*c, sd * factor);
                seen.p_value <= rules.alpha_track && list[*c].admits(seen.size)
            };
            consistent.iter().copied().filter(is_significant).collect()
        };
        let candidates = significant(1.0);
        // Evidence of the forces for a size estimated by the channel.
        let mut force_gains = vec![0.0; list.len()];
        if candidates.len() > 1 {
            let without = self.force_misfit(residual_model);
            for c in candidates {
                let (candidate, size) = (&list[c], channel.score(c, sd).size);
                force_gains[c] = self.force_gain(residual_model, without, candidate, size);
            }
        }
        // The significant candidate of the largest posterior density.
        let selected = |factor: f64| -> Option<usize> {
            let posterior = |c: usize| {
                let seen = channel.score(c, sd * factor);
                let penalty = self.prior_penalty(&list[c], seen.size, sd);
                (seen.size / seen.error).powi(2) + force_gains[c] - penalty
            };
            let candidates = significant(factor).into_iter();
            candidates.max_by(|a, b| posterior(*a).total_cmp(&posterior(*b)))
        };
        let named = selected(1.0)?;
        let seen = channel.score(named, sd);
        // A rival is excluded if the forces contradict its size but not the named one's.
        let needed = rules.track_rivals.needed_t.powi(2);
        let contradicted = |j: &usize| force_gains[*j] < force_gains[named] - needed;
        let rivals = consistent.iter().copied();
        let rivals = rivals.filter(|j| *j != named && !contradicted(j));
        let others = rivals.map(|j| {
            let seen = channel.score(j, sd);
            Rival {
                correlation: channel.correlation(named, j, sd),
                t_of_named_beyond: channel.t_given(named, j, sd),
                in_class: true,
                ..list[j].rival(seen.size, seen.size / seen.error)
            }
        });
        let t = seen.size / seen.error;
        let (class, rivals) = rules.track_rivals.class(
            &NamedEffect {
                effect: &list[named].effect,
                t,
                gain: t * t,
                units: self.training.len(),
            },
            others.collect(),
        );
        let candidate = list[named].clone();
        let error = seen.error.hypot(self.line_sd(&candidate));
        if selected(2.0).is_none() {
            account.depends.push(on_survey(format!(
                "{} is significant at the stated survey deviation but not at twice it",
                candidate.effect
            )));
        }
        let place = ("all runs", CHANNEL_NAMES[TRACK]);
        Some(Selection {
            class,
            rivals,
            p_value: seen.p_value,
            parameters: self.track_estimate(&candidate, seen.size, error),
            ..Selection::new(candidate, seen.size, seen.error, place)
        })
    }

    /// The departure of the track's profile from its survey, if it is significant and plausible.
    fn profile_departure(
        &self,
        residual_model: &ResidualModel,
        track: &SurveyedTrack,
        account: &mut Account,
    ) -> Option<Selection<Amplitude>> {
        let (channel, sd) = (&track.channel, track.sd);
        let alpha = self.rules().alpha_track;
        let profile = self.candidates.track.iter().find(|c| c.is_profile())?;
        let mut active = residual_model.effects.active.iter();
        if active.any(|e| e.effect_name() == profile.effect) {
            return None;
        }
        let ProfileDeparture {
            p_value,
            track,
            from_m,
            to_m,
            slope,
            needed_sd,
        } = channel.profile(sd);
        if p_value > alpha {
            if channel.profile(0.5 * sd).p_value <= alpha && needed_sd > sd {
                account.remarks.push(format!("the track's profile would be off if its survey were twice as good as stated; {needed_sd:.5} rad fits it"));
            }
            return None;
        }
        // A slope error beyond the bounds of a profile is not an error of the survey.
        if !profile.admits(slope) {
            account.remarks.push(format!(
                "on track {track}, s {from_m:.0}-{to_m:.0} m, the speed's derivative, the accelerometer and the slope disagree by {slope:.3} rad, more than a plausible profile error: a sensor or the distance is wrong there"
            ));
            return None;
        }
        if channel.profile(2.0 * sd).p_value > alpha {
            account.depends.push(on_survey(format!(
                "the track's profile departs from its survey at the stated deviation of {sd:.5} rad, not at twice it; {needed_sd:.5} rad fits it"
            )));
        }
        let candidate = profile.within(&track, from_m, to_m);
        let place = format!(
            "s {from_m:.0}-{to_m:.0} m on track {track} most; the whole profile departs by {needed_sd:.5} rad"
        );
        let place = (place.as_str(), CHANNEL_NAMES[TRACK]);
        Some(Selection {
            parameters: self.track_estimate(&candidate, slope, needed_sd),
            p_value,
            ..Selection::new(candidate, slope, needed_sd, place)
        })
    }

    /// Misfit of the forces with a model, after a refit of base and installation errors: at their
    /// values without a candidate they would represent part of it.
    fn force_misfit(&self, model: &ResidualModel) -> Option<f64> {
        let fit = self.fitted_anew(model, Vec::new()).ok()?;
        let model = ResidualModel {
            model_error: model.model_error,
            ..fit.residual_model
        };
        Some(self.penalised_misfit(&model, &fit.whitener))
    }

    /// Twice the decrease of the forces' misfit by a candidate of this size, relative to the misfit
    /// `without` it; negative if the forces contradict the candidate, 0 if a fit fails.
    fn force_gain(
        &self,
        residual_model: &ResidualModel,
        without: Option<f64>,
        candidate: &Candidate<Amplitude>,
        size: f64,
    ) -> f64 {
        let active = candidate.active(size);
        let mut with = residual_model.with(active.clone());
        with.frozen.push(active.name);
        let both = without.zip(self.force_misfit(&with));
        both.map_or(0.0, |(without, with)| 2.0 * (without - with))
    }

    /// Mean of the recorded speed over all samples of the training runs [m/s].
    fn mean_speed(&self) -> f64 {
        let frames = self.training.iter();
        let speeds = frames.flat_map(|frame| frame.samples().map(|i| frame.v[i]));
        let [sum, count] = speeds.fold([0.0; 2], |[sum, n], v| [sum + v, n + 1.0]);
        sum / f64::max(count, 1.0)
    }

    /// Standard deviation of a scale or an offset of the speed due to the length of the driven
    /// line, which differs from the surveyed distance.
    fn line_sd(&self, candidate: &Candidate<Amplitude>) -> f64 {
        // The channel's candidates without a unit, or in m/s, are the speed's.
        match candidate.unit.as_str() {
            "" => self.rules().line_share,
            "m/s" => self.rules().line_share * self.mean_speed(),
            _ => 0.0,
        }
    }

    /// The track channel's estimate as a parameter: forces do not depend on a slope.
    fn track_estimate(
        &self,
        candidate: &Candidate<Amplitude>,
        size: f64,
        error: f64,
    ) -> Vec<Fitted> {
        let half = self.options.rules.search.interval * error;
        vec![Fitted {
            name: candidate.key.clone(),
            value: size,
            low: size - half,
            high: size + half,
            unit: candidate.unit.clone(),
        }]
    }
}
