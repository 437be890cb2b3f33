//! Comparison of two models on the held-out runs, all channels together.
//!
//! Each model has the installation errors of the held-out runs that are most probable with it. With
//! residuals r weighted by their covariance on the training runs (with contacts by their variances
//! alone), pieces k of the held-out runs, installation errors a in standard deviations, and m the
//! mean residual of the training runs at the same place of the same track:
//!
//! ```text
//! by = sum_k (r_from^2 - (r_to g_from / g_to)^2) + a_from^2 - a_to^2        repeats = sum r_from . m
//! ```
//!
//! g is the expected standard deviation of a residual's noise. Contacts of a run are estimated from
//! its lateral residual, which is therefore compared without them; the evidence of the contacts in
//! it ([`log_likelihood_ratio`]) is added instead.
//!
//! Rows of the track channel are rates of the speed between the halves of its bins: the speed's
//! derivative is noisy, and a change of time would redistribute that noise.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::evidence::runs::campaign::{Campaign, RunFit, UnwrittenEffect};
use crate::evidence::runs::contacts::grip::subtract_grip;
use crate::evidence::runs::contacts::likelihood::{correlated_rows, log_likelihood_ratio};
use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::contacts::run_contacts::{
    residuals_without, rows_in_contact, without_pushes,
};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::fit::row_noise::expected;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNEL_NAMES, CHANNELS, ChannelRows, ResidualModel, TRACK,
};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::outcome::choose::PIECE_ROWS;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::track::bins::{numbered_rates, rates};
use crate::finding::{Interval, undetermined_share};
use crate::procedure::misfit_decrease::Decrease;

/// Upper limit of [`log_likelihood_ratio`] under noise alone, at the probability that a normal
/// variate exceeds one standard error: `2 ln (1 / 0.159)`.
const EVIDENCE_UNDER_NOISE: f64 = 3.7;

/// A model with the installation errors of the training runs and with those of the held-out runs.
pub struct ComparedModel<'f> {
    pub training: &'f ResidualModel,
    pub held_out: &'f ResidualModel,
}

/// Channel, track and place.
type Place<'a> = (usize, &'a str, i64);

impl Campaign<'_> {
    /// A fit in the training and in the held-out runs.
    pub fn compared<'f>(&self, fit: &'f RunFit) -> ComparedModel<'f> {
        let training = &fit.residual_model;
        let installed = || self.installed_in(training, &self.held_out);
        ComparedModel {
            training,
            held_out: fit.held_out.get_or_init(installed),
        }
    }

    /// Decrease of the held-out misfit from `from` to `to`; `None` without held-out runs.
    pub fn held_out_decrease(&self, from: &RunFit, to: &RunFit) -> Option<Decrease> {
        let [before, after] = [from, to].map(|fit| self.compared(fit));
        let comparison = Comparison::new(self, [&before, &after], to.unwritten.as_ref());
        let decrease = comparison.decrease([&before, &after])?;
        let [distance, distance_after] =
            [&before, &after].map(|model| model.held_out.installation.penalty());
        Some(Decrease {
            repeats: self.repeats(&before),
            ..decrease.with_prior(2.0 * (distance - distance_after))
        })
    }

    /// Repeatable misfit of a model: residuals of the held-out runs times the mean ones of the
    /// training runs at the same place.
    fn repeats(&self, model: &ComparedModel) -> f64 {
        let width = self.rules().track_bin_m;
        let (learned, whitener) = self.training_rows(model.training);
        let means = self.means(&learned, &whitener);
        let of_run = |frame: &Frame| {
            let few = without_pushes(frame);
            let frame = &few.at_every_sample();
            let rows = compared_rows(model.held_out, frame, width, &whitener);
            repeated(self.placed(frame, &rows), &means, &shares(&few, frame))
        };
        let each: Vec<f64> = self.held_out.par_iter().map(of_run).collect();
        each.iter().sum::<f64>().max(0.0)
    }

    /// Rows of the training runs and their whitening.
    fn training_rows(&self, model: &ResidualModel) -> (Vec<ChannelRows>, Whitener) {
        let learned = self.comparison_rows(model, &self.training);
        let whitener = Whitener::estimate(&self.training, &learned, self.used);
        (learned, whitener)
    }

    /// Closed share of the held-out contacts' misfit above noise, in the balances that the contacts
    /// were not estimated from. The interval follows from the scatter of runs.
    pub fn contacts_closed(&self, with: &ComparedModel) -> Interval {
        let rows = residuals(with.training, &self.training);
        let whitener = Whitener::estimate(&self.training, &rows, self.used).uncorrelated();
        let with = with.held_out;
        let bare = ResidualModel {
            contacts: None,
            ..with.clone()
        };
        let of_run = |frame: &Frame| -> [f64; 2] {
            let is_in_contact = rows_in_contact(frame);
            let square = |model: &ResidualModel| -> f64 {
                let rows = whitener.rows(frame, &model.residuals(frame));
                let both = [0, 2]
                    .into_iter()
                    .flat_map(|c| rows[c].iter().zip(&is_in_contact));
                let at_contacts = both.filter(|(_, is_in_contact)| **is_in_contact);
                at_contacts.map(|(r, _)| r * r - 1.0).sum()
            };
            let before = square(&bare);
            [before, before - square(with)]
        };
        let each: Vec<[f64; 2]> = self.held_out.iter().map(of_run).collect();
        let total: f64 = each.iter().map(|[before, _]| before).sum();
        let decreases: Vec<f64> = each.iter().map(|[_, decrease]| *decrease).collect();
        let decrease = Decrease::over(&decreases).filter(|_| total > 0.0);
        let share = |by: f64| (by / total).clamp(-1.0, 1.0);
        decrease.map_or(undetermined_share(0.0), |decrease| {
            let half = self.options.rules.search.interval * decrease.error;
            Interval {
                value: share(decrease.by),
                low: share(decrease.by - half),
                high: share(decrease.by + half),
            }
        })
    }

    /// Mean whitened residuals of the training runs by place, for places with at least two runs.
    fn means(&self, rows: &[ChannelRows], whitener: &Whitener) -> BTreeMap<Place<'_>, f64> {
        let mut sums: BTreeMap<Place, (f64, f64)> = BTreeMap::new();
        let mut visits: BTreeMap<Place, usize> = BTreeMap::new();
        for (frame, rows) in self.training.iter().zip(rows) {
            let rows = whitener.rows(frame, rows);
            let mut here: BTreeMap<Place, (f64, f64)> = BTreeMap::new();
            for (place, r) in self.placed(frame, &rows) {
                let sum = here.entry(place).or_default();
                (sum.0, sum.1) = (sum.0 + r, sum.1 + 1.0);
            }
            for (place, (sum, count)) in here {
                let all = sums.entry(place).or_default();
                (all.0, all.1) = (all.0 + sum, all.1 + count);
                *visits.entry(place).or_default() += 1;
            }
        }
        sums.into_iter()
            .filter(|(place, _)| visits[place] > 1)
            .map(|(place, (sum, count))| (place, sum / count))
            .collect()
    }

    /// Rows with their places.
    fn placed<'a>(&self, frame: &'a Frame, rows: &ChannelRows) -> Vec<(Place<'a>, f64)> {
        let rules = self.rules();
        let s = frame.rows(&frame.s);
        let at = |s: &f64| (s / rules.window_m).floor() as i64;
        let mut placed = Vec::new();
        for (c, rows) in rows.iter().enumerate() {
            let places: Vec<i64> = match c {
                TRACK => {
                    let bins = numbered_rates(frame, &s, rules.track_bin_m);
                    bins.into_iter().map(|(bin, _)| bin).collect()
                }
                _ => s.iter().map(at).collect(),
            };
            let both = places.into_iter().zip(rows);
            placed.extend(both.map(|(place, r)| ((c, frame.track.as_str(), place), *r)));
        }
        placed
    }
}

/// What the residuals of two models on a run are compared with.
struct Comparison<'a> {
    campaign: &'a Campaign<'a>,
    /// Of the first model on the training runs.
    whitener: Whitener,
    /// The smaller model error of each balance: with a large effect, the noise of the better model
    /// applies to both.
    model_error: [f64; BALANCES],
    /// Whether one model alone has contacts: they are then tested by the predictions of other runs.
    by_contacts: bool,
    /// Number of lateral rows per independent one at the contacts of each model; 1 without contacts.
    rows_per_independent: [f64; 2],
    /// An effect of the second model that simulations cannot include.
    unwritten: Option<&'a UnwrittenEffect>,
}

impl<'a> Comparison<'a> {
    fn new(
        campaign: &'a Campaign<'a>,
        models: [&ComparedModel; 2],
        unwritten: Option<&'a UnwrittenEffect>,
    ) -> Self {
        let [before, after] = models.map(|model| model.training);
        let (learned, mut whitener) = campaign.training_rows(before);
        // A contact is subtracted from one balance but not from the other: their residuals then do
        // not share noise as whitening assumes.
        if before.contacts.is_some() || after.contacts.is_some() {
            whitener = whitener.uncorrelated();
        }
        let correlated = |contacts: &Contacts| {
            let rows: Vec<ChannelRows> = (campaign.training.iter().zip(&learned))
                .map(|(frame, rows)| whitener.rows(frame, rows))
                .collect();
            correlated_rows(contacts, &campaign.training, &rows)
        };
        Self {
            model_error: std::array::from_fn(|c| before.model_error[c].min(after.model_error[c])),
            by_contacts: before.contacts.is_some() != after.contacts.is_some(),
            rows_per_independent: [before, after]
                .map(|model| model.contacts.as_ref().map_or(1.0, correlated)),
            campaign,
            unwritten,
            whitener,
        }
    }

    /// The decrease over the held-out runs, without the prior's part.
    fn decrease(&self, models: [&ComparedModel; 2]) -> Option<Decrease> {
        let held_out = self.campaign.held_out.par_iter();
        let in_held_out = models.map(|model| model.held_out);
        let each: Vec<(Vec<[f64; CHANNELS]>, f64)> = held_out
            .map(|run| self.decrease_on(run, in_held_out))
            .collect();
        let pieces = each.iter().flat_map(|(pieces, _)| pieces.clone());
        let pieces: Vec<[f64; CHANNELS]> = pieces.collect();
        if !self.by_contacts {
            let training = self.campaign.training.par_iter();
            let in_training = models.map(|model| model.training);
            let learned = training.map(|run| sum(&self.decrease_on(run, in_training).0));
            let names = CHANNEL_NAMES.map(|(name, _)| name);
            return Decrease::over_channels(names, &pieces, &learned.collect::<Vec<_>>());
        }
        // The evidence under noise alone has a known bound and needs no scatter over runs. It alone
        // counts for contacts: their yaw residuals, each with a lever of its own, scatter by far
        // more than is learned.
        let evidence: f64 = each.iter().map(|(_, evidence)| evidence).sum();
        let totals: Vec<f64> = pieces.iter().map(|by| by.iter().sum()).collect();
        let decrease = Decrease::over(&totals)?;
        Some(Decrease {
            by: decrease.by + evidence,
            error: decrease.error.hypot(EVIDENCE_UNDER_NOISE),
            weighted: Some([evidence, EVIDENCE_UNDER_NOISE]),
            contact_evidence: Some([evidence, EVIDENCE_UNDER_NOISE]),
            ..decrease
        })
    }

    /// The decrease on one run by piece and channel, and the increase of the contacts' evidence.
    fn decrease_on(
        &self,
        run: &Frame,
        [before, after]: [&ResidualModel; 2],
    ) -> (Vec<[f64; CHANNELS]>, f64) {
        let (rules, whitener) = (self.campaign.rules(), &self.whitener);
        let few = without_pushes(run);
        // A delay in one model alone changes the phase of the noise: rows at one phase only would
        // differ by chance.
        let frame = &few.at_every_sample();
        let shares = shares(&few, frame);
        let mut rows = compared_rows(before, frame, rules.track_bin_m, whitener);
        let alike = whitener.with_sd(self.deviations(frame, [before, after]));
        let mut after_rows = compared_rows(after, frame, rules.track_bin_m, &alike);
        if let Some(effect) = self.unwritten {
            let candidate = &effect.candidate;
            let direction = self.campaign.direction(after, whitener, candidate, frame);
            for (rows, direction) in after_rows.iter_mut().zip(&direction) {
                for (row, change) in rows.iter_mut().zip(direction) {
                    *row -= change * effect.size / candidate.typical;
                }
            }
        }
        if self.by_contacts {
            let most = rules.contacts.most_of_a_row;
            for row in rows[1].iter_mut().chain(&mut after_rows[1]) {
                *row = row.clamp(-most, most);
            }
        }
        let pieces = few.row_count().div_ceil(PIECE_ROWS).max(1);
        let [own, next] = [(before, 0), (after, 1)].map(|(model, k)| {
            let share = shares[1] / self.rows_per_independent[k];
            self.contact_evidence(model, frame, share)
        });
        (decreases(&rows, &after_rows, &shares, pieces), next - own)
    }

    /// Standard deviation of each balance's residual with the second model: less weight of the
    /// measurements lowers the residual without explaining more.
    fn deviations(&self, frame: &Frame, models: [&ResidualModel; 2]) -> [f64; BALANCES] {
        let [noise, noise_after] = models.map(|model| {
            let alike = ResidualModel {
                model_error: self.model_error,
                ..model.clone()
            };
            expected(&alike, frame)
        });
        std::array::from_fn(|c| {
            let ratio = noise_after[(c, c)] / noise[(c, c)];
            let is_known = ratio.is_finite() && ratio > 0.0;
            self.whitener.sd[c] * if is_known { ratio.sqrt() } else { 1.0 }
        })
    }

    /// Evidence of a model's contacts in a run; 0 if both models have contacts or none has.
    ///
    /// The residual that a contact was estimated from is no evidence of it: contacts of other runs
    /// predict it. `share`: fraction of independent rows.
    fn contact_evidence(&self, model: &ResidualModel, frame: &Frame, share: f64) -> f64 {
        let Some(contacts) = model.contacts.as_ref().filter(|_| self.by_contacts) else {
            return 0.0;
        };
        let frames = std::slice::from_ref(frame);
        let mut own = residuals_without(model, frames);
        subtract_grip(model, frames, &mut own);
        let sd = self.whitener.sd[1];
        let side: Vec<f64> = frame.rows(&own[0][1]).iter().map(|y| y / sd).collect();
        log_likelihood_ratio(contacts, frame, &side, sd, share)
    }
}

/// Residuals of a model, with contacts not subtracted from the lateral balance that they were
/// estimated from.
pub fn with_whole_side(model: &ResidualModel, frame: &Frame) -> ChannelRows {
    let mut rows = model.residuals(frame);
    if model.contacts.is_some() {
        let bare = residuals_without(model, std::slice::from_ref(frame));
        rows[1] = frame.rows(&bare[0][1]);
    }
    rows
}

/// Weight of a row of each channel if rows are made at every sample; 1 in the track channel.
fn shares(thinned: &Frame, dense: &Frame) -> [f64; CHANNELS] {
    let share = thinned.row_count() as f64 / dense.row_count().max(1) as f64;
    std::array::from_fn(|c| if c == TRACK { 1.0 } else { share })
}

/// The rows of a held-out run that are compared; `width`: bins of the track channel \[m\].
fn compared_rows(
    model: &ResidualModel,
    frame: &Frame,
    width: f64,
    whitener: &Whitener,
) -> ChannelRows {
    let mut rows = with_whole_side(model, frame);
    rows[TRACK] = rates(frame, &rows[TRACK], width);
    whitener.rows(frame, &rows)
}

/// Weighted sum of products of rows and mean training residuals at the same place.
fn repeated(
    placed: Vec<(Place, f64)>,
    means: &BTreeMap<Place, f64>,
    shares: &[f64; CHANNELS],
) -> f64 {
    placed
        .iter()
        .filter_map(|(place, r)| means.get(place).map(|mean| shares[place.0] * mean * r))
        .sum()
}

/// Decrease of each channel's weighted sum of squares, by piece of a run.
fn decreases(
    before: &ChannelRows,
    after: &ChannelRows,
    shares: &[f64; CHANNELS],
    pieces: usize,
) -> Vec<[f64; CHANNELS]> {
    let mut decreases = vec![[0.0; CHANNELS]; pieces];
    for (c, (before, after)) in before.iter().zip(after).enumerate() {
        let rows = before.len().max(1);
        for (i, (b, a)) in before.iter().zip(after).enumerate() {
            decreases[i * pieces / rows][c] += shares[c] * (b * b - a * a);
        }
    }
    decreases
}

/// Sum over pieces, by channel.
fn sum(pieces: &[[f64; CHANNELS]]) -> [f64; CHANNELS] {
    std::array::from_fn(|c| pieces.iter().map(|piece| piece[c]).sum())
}
