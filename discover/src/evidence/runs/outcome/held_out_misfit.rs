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
use crate::evidence::runs::contacts::own::{residuals_without, rows_beneath, without_pushes};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::fit::row_noise::expected;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNEL_NAMES, CHANNELS, ChannelRows, ResidualModel, TRACK,
};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::outcome::choose::PIECE_ROWS;
use crate::evidence::runs::outcome::gap::comparison_rows;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::track::bins::{numbered_rates, rates};
use crate::finding::Interval;
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

    /// Decrease of the held-out misfit from `from` to `to`.
    pub fn decrease_between_fits(&self, from: &RunFit, to: &RunFit) -> Option<Decrease> {
        let [before, after] = [from, to].map(|fit| self.compared(fit));
        let decrease = self.decrease_between(&before, &after, to.unwritten.as_ref())?;
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
        let learned = comparison_rows(model, &self.training, self.rules().track_bin_m);
        let whitener = Whitener::estimate(&self.training, &learned, self.used);
        (learned, whitener)
    }

    /// The decrease for two models; the second may contain an effect outside simulations.
    fn decrease_between(
        &self,
        before: &ComparedModel,
        after: &ComparedModel,
        unwritten: Option<&UnwrittenEffect>,
    ) -> Option<Decrease> {
        let rules = self.rules();
        let width = rules.track_bin_m;
        let in_training = [before.training, after.training];
        let in_held_out = [before.held_out, after.held_out];
        let [before, after] = in_training;
        let (learned, mut whitener) = self.training_rows(before);
        // A contact is subtracted from one balance but not from the other: their residuals then do
        // not share noise as whitening assumes.
        if before.contacts.is_some() || after.contacts.is_some() {
            whitener = whitener.uncorrelated();
        }
        let alike = |contacts: &Contacts| {
            let rows: Vec<ChannelRows> = (self.training.iter().zip(&learned))
                .map(|(frame, rows)| whitener.rows(frame, rows))
                .collect();
            correlated_rows(contacts, &self.training, &rows)
        };
        let alike = [before, after].map(|model| model.contacts.as_ref().map_or(1.0, alike));
        // With a large effect, the noise of the better model applies to both.
        let model_error: [f64; BALANCES] =
            std::array::from_fn(|c| before.model_error[c].min(after.model_error[c]));
        // If only one model has contacts, they are tested by the predictions of other runs.
        let by_contacts = before.contacts.is_some() != after.contacts.is_some();
        let of_run = |frame: &Frame, [before, after]: [&ResidualModel; 2]| {
            let few = without_pushes(frame);
            // A delay in one model alone changes the phase of the noise: rows at one phase only
            // would differ by chance.
            let frame = &few.at_every_sample();
            let shares = shares(&few, frame);
            let mut rows = compared_rows(before, frame, width, &whitener);
            // Less weight of the measurements lowers the residual without explaining more.
            let [noise, noise_after] = [before, after].map(|model| {
                let alike = ResidualModel {
                    model_error,
                    ..model.clone()
                };
                expected(&alike, frame)
            });
            let sd = std::array::from_fn(|c| {
                let ratio = noise_after[(c, c)] / noise[(c, c)];
                let known = ratio.is_finite() && ratio > 0.0;
                whitener.sd[c] * if known { ratio.sqrt() } else { 1.0 }
            });
            let mut after_rows = compared_rows(after, frame, width, &whitener.with_sd(sd));
            if let Some(UnwrittenEffect {
                candidate, size, ..
            }) = unwritten
            {
                let direction = self.direction(after, &whitener, candidate, frame);
                for (rows, direction) in after_rows.iter_mut().zip(&direction) {
                    for (row, change) in rows.iter_mut().zip(direction) {
                        *row -= change * size / candidate.typical;
                    }
                }
            }
            if by_contacts {
                let most = rules.contacts.most_of_a_row;
                for row in rows[1].iter_mut().chain(&mut after_rows[1]) {
                    *row = row.clamp(-most, most);
                }
            }
            let pieces = (few.row_count() as f64 / PIECE_ROWS as f64).ceil() as usize;
            let decreases = decreases(&rows, &after_rows, &shares, pieces.max(1));
            // The residual that a contact was estimated from is no evidence of it: contacts of
            // other runs predict it.
            let observed = |model: &ResidualModel, alike: f64| {
                let contacts = model.contacts.as_ref().filter(|_| by_contacts)?;
                let mut own = residuals_without(model, std::slice::from_ref(frame));
                subtract_grip(model, std::slice::from_ref(frame), &mut own);
                let sd = whitener.sd[1];
                let side: Vec<f64> = frame.rows(&own[0][1]).iter().map(|y| y / sd).collect();
                Some(log_likelihood_ratio(
                    contacts,
                    frame,
                    &side,
                    sd,
                    shares[1] / alike,
                ))
            };
            let [own, next] = [(before, alike[0]), (after, alike[1])]
                .map(|(model, alike)| observed(model, alike).unwrap_or_default());
            (decreases, next - own)
        };
        let held_out = self.held_out.par_iter();
        let each: Vec<(Vec<[f64; CHANNELS]>, f64)> =
            held_out.map(|run| of_run(run, in_held_out)).collect();
        let decreases: Vec<[f64; CHANNELS]> = each
            .iter()
            .flat_map(|(decreases, _)| decreases.clone())
            .collect();
        let observed: f64 = each.iter().map(|(_, observed)| observed).sum();
        if !by_contacts {
            let training = self.training.par_iter();
            let learned = training.map(|run| sum(&of_run(run, in_training).0));
            let names = CHANNEL_NAMES.map(|(name, _)| name);
            return Decrease::over_channels(names, &decreases, &learned.collect::<Vec<_>>());
        }
        // The evidence under noise alone has a known bound and needs no scatter over runs. It alone
        // counts for contacts: their yaw residuals, each with a lever of its own, scatter by far
        // more than is learned.
        let totals: Vec<f64> = decreases.iter().map(|by| by.iter().sum()).collect();
        let decrease = Decrease::over(&totals, 0.0)?;
        Some(Decrease {
            by: decrease.by + observed,
            error: decrease.error.hypot(EVIDENCE_UNDER_NOISE),
            weighted: Some([observed, EVIDENCE_UNDER_NOISE]),
            contact_evidence: Some([observed, EVIDENCE_UNDER_NOISE]),
            ..decrease
        })
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
            let beneath = rows_beneath(frame);
            let square = |model: &ResidualModel| -> f64 {
                let rows = whitener.rows(frame, &model.residuals(frame));
                let contact_rows = |c: usize| rows[c].iter().zip(&beneath).filter(|(_, b)| **b);
                [0, 2]
                    .iter()
                    .flat_map(|c| contact_rows(*c))
                    .map(|(r, _)| r * r - 1.0)
                    .sum()
            };
            let before = square(&bare);
            [before, before - square(with)]
        };
        let each: Vec<[f64; 2]> = self.held_out.iter().map(of_run).collect();
        let total: f64 = each.iter().map(|[before, _]| before).sum();
        let decreases: Vec<f64> = each.iter().map(|[_, decrease]| *decrease).collect();
        let decrease = Decrease::over(&decreases, total).filter(|l| l.repeats > 0.0);
        let share = |by: f64| (by / total).clamp(-1.0, 1.0);
        decrease.map_or(
            Interval {
                value: 0.0,
                low: -1.0,
                high: 1.0,
            },
            |l| {
                let half = self.options.rules.search.interval * l.error;
                Interval {
                    value: share(l.by),
                    low: share(l.by - half),
                    high: share(l.by + half),
                }
            },
        )
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

/// Residuals of a model, with contacts not subtracted from the lateral balance that they were
/// estimated from.
pub fn with_whole_side(model: &ResidualModel, frame: &Frame) -> ChannelRows {
    let mut rows = model.residuals(frame);
    if model.contacts.is_some() {
        let [bare] = &residuals_without(model, std::slice::from_ref(frame))[..] else {
            return rows;
        };
        rows[1] = frame.rows(&bare[1]);
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
