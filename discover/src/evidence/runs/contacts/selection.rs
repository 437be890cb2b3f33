//! Selection of wall contacts: found from lateral differences between runs, tested by their yaw
//! residuals.

use kufe_sled::effects::{Active, Kind, Level};

use crate::error::Result;
use crate::evidence::runs::campaign::{Campaign, RunFit, channel_rms};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::contacts::MIN_HITS;
use crate::evidence::runs::contacts::grip::subtract_grip;
use crate::evidence::runs::contacts::hit::hit;
use crate::evidence::runs::contacts::levers::{
    excess, ratio, ratio_of_strong, shared_with_side, subtract_side_noise, yaw_p_value,
};
use crate::evidence::runs::contacts::model::{Contacts, wall};
use crate::evidence::runs::contacts::run_contacts::{
    residuals_without, set_contacts, set_contacts_of, without_contacts,
};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ChannelRows, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;
use crate::null::combined_p_value;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{ExtendedFit, Selection, Unexplained};

/// Random displacements of the contacts for the null distribution of the yaw residual.
const TRIALS: u64 = 999;

/// Contacts found by a screen, before a fit.
#[derive(Clone)]
pub struct FoundContacts {
    pub contacts: Contacts,
    /// All training runs with their own contacts.
    pub frames: Vec<Frame>,
    /// p-value by the yaw residual.
    pub p_value: f64,
    /// Reduction of the lateral sum of squares, in units of its variance.
    pub gain: f64,
    pub lever: Lever,
}

/// Where contacts act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lever {
    /// Between the runners.
    Between,
    /// Near a runner, whose own force they may be.
    AtRunner,
    /// Beyond the runners, where no force of one runner acts.
    Beyond,
}

impl FoundContacts {
    /// Why contacts near a runner or beyond it are not named.
    pub fn unexplained(&self) -> Unexplained {
        let (places, lever_m) = (places_in_words(&self.contacts), self.contacts.lever_m.value);
        Unexplained {
            reason: format!(
                "several runs were pushed aside at {places}, about {lever_m:.1} m in front of the centre of gravity, by a wall or by forces of the runners"
            ),
            decides: format!("marks on the wall, or a video of the runs, at {places}"),
        }
    }
}

impl Campaign<'_> {
    /// The significant contacts of the training runs given a model.
    pub fn find_contacts(&self, model: &ResidualModel) -> Option<FoundContacts> {
        let lateral = self.used[1] && self.used[2];
        if !lateral || model.contacts.is_some() || self.data.segmented {
            return None;
        }
        let effect = wall().filter(|e| self.options.includes(e.info.name))?;
        let whole = self.whole();
        let unchanged = residuals_without(model, whole);
        let mut residual = unchanged.clone();
        subtract_grip(model, whole, &mut residual);
        let side: Vec<Vec<f64>> = residual.iter().map(|l| l[1].clone()).collect();
        let rules = &self.options.rules.runs;
        let hit = hit(effect, whole, &side, &rules.contacts, self.options.seed)?;
        let mut frames = hit.frames;
        let mut places = hit_places(hit.places, &mut frames, &unchanged);
        if places.is_empty() {
            return None;
        }
        let interval = self.options.rules.search.interval;
        let shared_m = shared_with_side(&frames, &residual, 2);
        let ratio = |balance: usize| {
            let of_all = || ratio(&excess(&frames, &residual, balance, &places), interval);
            ratio_of_strong(&frames, &residual, balance, interval).unwrap_or_else(of_all)
        };
        let lever_m = ratio(2);
        let sled = &model.vehicle.sled;
        let inside = rules.contacts.inside;
        let inside = -inside * sled.l_r_m..inside * sled.l_f_m;
        let yaw = subtract_side_noise(&residual, shared_m);
        let by_yaw = yaw_p_value(&frames, &yaw, TRIALS, self.options.seed);
        let p_value = combined_p_value(hit.p_value, by_yaw);
        if hit.p_value > rules.contacts.met_by_chance || p_value > rules.contacts.alpha {
            return None;
        }
        let lever = if inside.contains(&lever_m.value) {
            Lever::Between
        } else if lever_m.low > sled.l_f_m || lever_m.high < -sled.l_r_m {
            Lever::Beyond
        } else {
            Lever::AtRunner
        };
        let mut friction = ratio(0);
        if !self.used[0] || friction.low <= 0.0 {
            friction = Default::default();
        }
        for (k, place) in places.iter_mut().enumerate() {
            let track = place.track.clone().unwrap_or_default();
            set_parameters(place, k, &frames, &track, [friction.value, lever_m.value]);
        }
        let contacts = Contacts {
            step: None,
            places,
            lever_m,
            friction,
        };
        let gain = self.side_gain(model, &contacts, &frames);
        Some(FoundContacts {
            contacts,
            frames,
            p_value,
            gain,
            lever,
        })
    }

    /// The training runs with all samples.
    pub fn whole(&self) -> &[Frame] {
        if self.whole.is_empty() {
            &self.training
        } else {
            &self.whole
        }
    }

    /// Reduction of the lateral sum of squares by contacts, in units of its variance.
    fn side_gain(&self, model: &ResidualModel, contacts: &Contacts, frames: &[Frame]) -> f64 {
        let with = ResidualModel {
            contacts: Some(contacts.clone()),
            ..model.clone()
        };
        let squares = |model: &ResidualModel| -> (f64, usize) {
            let rows = residuals(model, frames);
            let side = || rows.iter().flat_map(|r| &r[1]);
            (side().map(|x| x * x).sum(), side().count())
        };
        let ((before, n), (after, _)) = (squares(model), squares(&with));
        (before - after) * n as f64 / before.max(1e-300)
    }

    /// Contacts as a selected effect.
    pub fn select_contacts(&self, found: &FoundContacts) -> Option<Selection<Amplitude>> {
        let place = found.contacts.places.first()?;
        let Kind::Catalogue(effect) = &place.kind else {
            return None;
        };
        let force = effect.info.parameters.first()?;
        let yaw = 2;
        let act = Amplitude {
            kind: place.kind.clone(),
            parameter: 0,
            level: Level::Run,
            values: place.values.clone(),
            track: place.track.clone(),
            carrier: None,
        };
        let candidate = Candidate::of_catalogue(&effect.info, force, act);
        let error = place.values[5] / (self.whole().len() as f64).sqrt();
        let places = places_in_words(&found.contacts);
        let at = (places.as_str(), CHANNEL_NAMES[yaw]);
        Some(Selection {
            p_value: found.p_value,
            ..Selection::new(candidate, place.values[0], error, at)
        })
    }

    /// Fits base and effects without the samples during contacts, with new installation errors;
    /// then the contacts given these. Compares the root mean square of the yaw residual.
    pub fn add_contacts(
        &mut self,
        fit: &RunFit,
        found: FoundContacts,
        step: usize,
    ) -> Result<ExtendedFit<RunFit>> {
        self.whole = found.frames;
        self.training = self.whole.iter().map(without_contacts).collect();
        let base = self.fitted(&fit.residual_model, fit.owners.clone())?;
        // The first base was biased by the contacts; places are searched for again with an unbiased
        // one, unless so many runs differ that a whole track is excluded.
        let again = self.find_contacts(&base.residual_model);
        let again =
            again.filter(|again| again.lever == Lever::Between && again.gain > 0.5 * found.gain);
        let mut contacts = found.contacts;
        if let Some(again) = again {
            self.whole = again.frames;
            self.training = self.whole.iter().map(without_contacts).collect();
            contacts = again.contacts;
        }
        contacts.step = Some(step);
        let mut next = self.fitted_anew(&base.residual_model, fit.owners.clone())?;
        set_contacts(&mut self.held_out, &next.residual_model, &contacts.places);
        for model in [&mut next.residual_model, &mut next.final_model] {
            model.contacts = Some(contacts.clone());
        }
        let yaw = 2;
        let rms = |fit: &RunFit| channel_rms(&fit.residual_model, self.whole(), yaw);
        Ok(ExtendedFit {
            rms: [rms(fit), rms(&next)],
            place: Some(places_in_words(&contacts)),
            fit: next,
            is_writable: true,
        })
    }

    /// Adopts the places of contacts of the given model, and estimates the contacts of every run
    /// there.
    pub fn given_contacts(&mut self, contacts: Contacts) {
        set_contacts(&mut self.training, &self.given, &contacts.places);
        self.whole.clone_from(&self.training);
        self.training = self.whole.iter().map(without_contacts).collect();
        set_contacts(&mut self.held_out, &self.given, &contacts.places);
        self.given.contacts = Some(contacts);
    }
}

/// The places that several runs hit. Sets the contacts of the runs there.
///
/// Places are found after removal of grip variation. Forces are estimated from the full residual, as
/// in the held-out runs. A place without hits then has neither a force nor an interval and is
/// dropped.
fn hit_places(
    mut places: Vec<Active>,
    frames: &mut [Frame],
    residual: &[ChannelRows],
) -> Vec<Active> {
    loop {
        for (frame, residual) in frames.iter_mut().zip(residual) {
            set_contacts_of(frame, &residual[1], &places);
        }
        let is_hit = |k: usize| {
            let own = frames.iter().flat_map(|f| &f.contacts);
            own.filter(|own| own.place == k).count() >= MIN_HITS
        };
        let count = places.len();
        let hit = places.into_iter().enumerate().filter(|(k, _)| is_hit(*k));
        places = hit.map(|(_, place)| place).collect();
        if places.is_empty() || places.len() == count {
            return places;
        }
    }
}

/// Sets the parameters of a place: mean and standard deviation of the force over all runs of its
/// track (0 without a hit), and the mean interval of the hits.
fn set_parameters(
    place: &mut Active,
    k: usize,
    frames: &[Frame],
    track: &str,
    [friction, lever]: [f64; 2],
) {
    let hits: Vec<_> = frames
        .iter()
        .flat_map(|f| f.contacts.iter().filter(|own| own.place == k))
        .map(|own| own.contact)
        .collect();
    let runs = frames.iter().filter(|f| f.track == track).count().max(1) as f64;
    let count = hits.len().max(1) as f64;
    let mean =
        |of: &dyn Fn(&kufe_sled::WallContact) -> f64| hits.iter().map(of).sum::<f64>() / count;
    let force = mean(&|c| c.force_n) * count / runs;
    let squares = mean(&|c| c.force_n.powi(2)) * count / runs;
    let (from, to) = (mean(&|c| c.s_m), mean(&|c| c.s_m + c.length_m));
    let within = (from - place.values[1]).max(place.values[2] - to).max(0.0);
    let spread = (squares - force * force).max(0.0).sqrt().max(1.0);
    let tenth = |x: f64| (10.0 * x).round() / 10.0;
    place.values = vec![
        tenth(force),
        tenth(from),
        tenth(to),
        friction,
        lever,
        tenth(spread),
        tenth(within),
    ];
}

/// The places in words.
fn places_in_words(contacts: &Contacts) -> String {
    let names = contacts.places.iter().map(|place| {
        let v = &place.values;
        let track = place.track.as_deref().unwrap_or("every track");
        format!("s {:.0}-{:.0} m on track {track}", v[1], v[2])
    });
    names.collect::<Vec<_>>().join("; ")
}
