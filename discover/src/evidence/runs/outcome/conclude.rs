//! Results of a search over runs: parameters, closed shares, significant bins.

use kufe_sled::Model;
use kufe_sled::effects::{Active, Custom, Kind};

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::catalogue::Candidates;
use crate::evidence::runs::model::residual_model::{
    BASE_NAMES, CHANNEL_NAMES, ResidualModel, TRACK,
};
use crate::evidence::runs::outcome::bins::significant_bins;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::track::channel::TrackChannel;
use crate::finding::{Bin, Fitted, Interval, Step, undetermined_share};
use crate::null::clusters::session_numbers;
use crate::options::OUTSIDE_CATALOGUE;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::Dependence;
use crate::procedure::shared_effects::Amount;

impl Campaign<'_> {
    /// Parameters of the added effects with their intervals, by step. The error of a window's edges
    /// is added to the interval in quadrature.
    pub fn parameters(&self, last: &RunFit, steps: usize) -> Vec<Vec<Fitted>> {
        let (after, already) = (&last.residual_model, last.already());
        let estimates = &last.estimates[self.free.len()..];
        let (edges_m, quantile) = (self.rules().edges_m, self.options.rules.search.interval);
        let mut parameters = vec![Vec::new(); steps];
        for ((e, q), est) in after.free().into_iter().zip(estimates) {
            if e < already {
                continue;
            }
            let (name, unit) = match &after.effects.active[e].kind {
                Kind::Catalogue(kind) => {
                    let p = &kind.info().parameters[q];
                    (p.name.to_owned(), p.unit.to_owned())
                }
                Kind::Custom(custom) => ("value".to_owned(), custom.unit.clone()),
            };
            let edges = as_candidate(&after.effects.active[e], &self.candidates.local)
                .and_then(|local| local.window())
                .map_or(0.0, |(from, to)| edges_m / (to - from).max(edges_m));
            let wider = |way: f64| way.hypot(quantile * edges * est.value);
            parameters[last.owners[e - already]].push(Fitted {
                name,
                value: est.value,
                low: est.value - wider(est.value - est.low),
                high: est.value + wider(est.high - est.value),
                unit,
            });
        }
        if let Some(unwritten) = &last.unwritten {
            let amount = Amount::of(&unwritten.candidate, unwritten.size, unwritten.error);
            parameters[unwritten.step].push(amount.fitted(quantile));
        }
        self.contact_parameters(last, &mut parameters);
        parameters
    }

    /// The formula of each step that is a custom law; of several, each with its channel.
    pub fn laws(&self, last: &RunFit, steps: usize) -> Vec<Option<String>> {
        let mut laws: Vec<Vec<&Custom>> = vec![Vec::new(); steps];
        let own = last.residual_model.effects.active[last.already()..].iter();
        for (active, step) in own.zip(&last.owners) {
            let is_outside = active.name.split(':').next() == Some(OUTSIDE_CATALOGUE);
            if let (Kind::Custom(custom), true) = (&active.kind, is_outside) {
                laws[*step].push(custom);
            }
        }
        if let Some(unwritten) = &last.unwritten
            && let Kind::Custom(custom) = &unwritten.candidate.act.kind
        {
            laws[unwritten.step].push(custom);
        }
        laws.iter().map(|laws| formulas(laws)).collect()
    }

    /// Base parameters with their intervals.
    pub fn base_parameters(&self, last: &RunFit) -> Vec<Fitted> {
        self.free
            .iter()
            .zip(&last.estimates)
            .map(|(b, est)| {
                let scale = base_value(self.model, *b);
                let is_stiffness = BASE_NAMES[*b].ends_with("rad");
                Fitted {
                    name: BASE_NAMES[*b].to_owned(),
                    value: est.value * scale,
                    low: est.low * scale,
                    high: est.high * scale,
                    unit: if is_stiffness { "N/rad" } else { "" }.to_owned(),
                }
            })
            .collect()
    }

    /// Closed share of the explainable misfit on the held-out runs, by step.
    pub fn closed_shares(&self, base: &RunFit, last: &RunFit, steps: &[Step]) -> Vec<Interval> {
        if steps.is_empty() || base.whitener.count() == 0 || self.held_out.is_empty() {
            return Vec::new();
        }
        let [base_model, last_model] = [base, last].map(|fit| self.compared(fit));
        let simulator = self.simulator(last_model.training);
        let Candidates {
            regular,
            local,
            levels,
            ..
        } = &self.candidates;
        let added = last.residual_model.effects.active[last.already()..].iter();
        let found_locals = added.filter_map(|active| as_candidate(active, local));
        let is_found = |c: &&Candidate<Amplitude>| steps.iter().any(|step| step.effect == c.effect);
        let everywhere = regular
            .iter()
            .chain(levels.iter().filter(is_found))
            .cloned();
        let directions: Vec<Candidate<Amplitude>> = everywhere.chain(found_locals).collect();
        let models = [base_model.training, base_model.held_out];
        let models = models.map(ResidualModel::without_discrepancy);
        let designs = models
            .each_ref()
            .map(|model| self.design(model, &base.whitener, &directions));
        let after = last_model.held_out;
        let closed = self.explainable_closed(designs.each_ref(), after, &simulator);
        let held_out = [base_model.held_out, last_model.held_out];
        let by_track = || self.track_closed(held_out);
        let track = CHANNEL_NAMES[TRACK].0;
        let contacts = last.final_model.contacts.as_ref().and_then(|c| c.step);
        let of_step = |(k, step): (usize, &Step)| {
            if step.channel == track {
                // Without significance in the forces the share is that of the track's bins, of
                // which these runs have few.
                by_track()
            } else if contacts == Some(k) {
                self.contacts_closed(&last_model)
            } else {
                closed
            }
        };
        steps.iter().enumerate().map(of_step).collect()
    }

    /// Closed share of the track channel's mean square on the held-out runs, less its scatter;
    /// without an interval.
    fn track_closed(&self, models: [&ResidualModel; 2]) -> Interval {
        let [before, after] = models.map(|model| {
            let channel = TrackChannel::new(model, &self.held_out, self.rules());
            channel.map(|channel| channel.closure().powi(2))
        });
        undetermined_share(match (before, after) {
            (Some(before), Some(after)) if before > 0.0 => (1.0 - after / before).clamp(-1.0, 1.0),
            _ => 0.0,
        })
    }

    /// Whether bins are significant that are not so in any simulated run: noisy inputs bias bins in
    /// every run alike.
    pub fn has_significant_bins(&self, last: &RunFit, bins: &[Bin]) -> bool {
        let simulator = self.simulator(&last.final_model);
        let limit = self.rules().alpha_levels;
        let are_strong = |bins: &[Bin]| bins.iter().any(|b| b.p_value <= limit);
        let by_noise = |k: u64| {
            let model = &last.residual_model;
            let simulated = simulator.simulated(&self.training, model, 5_000_011 + k);
            are_strong(&significant_bins(last, &simulated, self.options.seed))
        };
        are_strong(bins) && !(0..6).any(by_noise)
    }
}

/// The formulas of a step's laws in the order of its parameters; `None` without any.
fn formulas(laws: &[&Custom]) -> Option<String> {
    match laws {
        [] => None,
        [one] => Some(one.text.clone()),
        _ => {
            let each = laws.iter();
            let each = each.map(|law| format!("{} on {}", law.text, law.channel.name()));
            Some(each.collect::<Vec<_>>().join("; "))
        }
    }
}

/// Steps that are not significant at this level if the runs of a session share an error.
pub fn shared_faults(steps: &[Step], training: &[Frame], alpha: f64) -> Vec<Dependence> {
    let sessions = session_numbers(training.iter().map(|frame| frame.session.as_str()));
    let count = sessions.iter().max().map_or(0, |last| last + 1);
    let of = |step: &Step| {
        let p_runs = step.p_runs.filter(|p| *p <= alpha)?;
        let p = step.p_sessions.filter(|p| *p > alpha)?;
        Some(Dependence {
            assumption: format!(
                "{}: if the runs of a session share an error, this is not significant (p = {p:.2} with {count} sessions, {p_runs:.1e} with all runs independent)",
                step.effect
            ),
            decides: format!(
                "{count} more sessions, with the sensors taken off and mounted anew before each and a recording at rest on level ice"
            ),
        })
    };
    steps.iter().filter_map(of).collect()
}

/// An active local effect as the candidate it was selected as; `None` if it is not local.
fn as_candidate(active: &Active, locals: &[Candidate<Amplitude>]) -> Option<Candidate<Amplitude>> {
    let local = locals
        .iter()
        .find(|l| l.effect == active.effect_name() && active.values[l.act.parameter] != 0.0)?;
    let mut candidate = local.clone();
    candidate.act.values = active.values.clone();
    candidate.act.values[local.act.parameter] = 0.0;
    candidate.act.track = active.track.clone();
    Some(candidate)
}

/// Given value of a base parameter; 1 for friction that is not constant.
pub(super) fn base_value(model: &Model, b: usize) -> f64 {
    match b {
        1 => model.friction.front.mu_zeta,
        2 => model.friction.front.k_n_per_rad,
        3 => model.friction.rear.mu_zeta,
        4 => model.friction.rear.k_n_per_rad,
        _ => match model.friction.longitudinal.model() {
            Ok(kufe_sled::friction::Longitudinal::Fixed(mu)) => mu,
            _ => 1.0,
        },
    }
}

#[cfg(test)]
mod tests {
    use kufe_sled::effects::Channel;

    use super::*;

    #[test]
    fn a_law_of_two_terms_states_both() {
        let law = |channel, text| Custom::new(channel, text, None).unwrap();
        let side = law(Channel::Lateral, "alpha_rad");
        let friction = law(Channel::Friction, "abs(alpha_rad)");
        assert_eq!(formulas(&[]), None);
        assert_eq!(formulas(&[&side]).unwrap(), "alpha_rad");
        assert_eq!(
            formulas(&[&side, &friction]).unwrap(),
            "alpha_rad on lateral; abs(alpha_rad) on friction"
        );
    }
}
