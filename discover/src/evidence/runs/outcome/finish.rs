//! The end of a search: parameters, the locked-away runs, the verdict.

use kufe_sled::Model;
use kufe_sled::effects::Kind;

use crate::error::Error;
use crate::evidence::runs::candidates::candidate::Candidate;
use crate::evidence::runs::fit::estimate::Estimate;
use crate::evidence::runs::fit::simulated_runs::TwinMaker;
use crate::evidence::runs::model::chain::{BASE_NAMES, CHANNEL_NAMES, Chain};
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::outcome::by_run::by_run;
use crate::evidence::runs::outcome::gap;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::track_channel::TrackChannel;
use crate::evidence::runs::search::Found;
use crate::evidence::runs::searcher::Searcher;
use crate::finding::report::{Fitted, HeldOut, Interval, Report, Verdict};

/// How far off the two edges of a stretch may be together, a standard deviation [m]: what it is too long it is too weak.
const EDGES_M: f64 = 1.5;

/// Where a search ends: before and after, and what was locked away.
pub struct Ends {
    /// The fitted base model.
    pub base: Chain,
    /// Its rows' whitening.
    pub whitener: Whitener,
    /// The model with all effects.
    pub after: Chain,
    /// Its rows' whitening.
    pub after_whitener: Whitener,
    /// Base parameters with leverage.
    pub free: Vec<usize>,
    /// Locked-away runs.
    pub held: Vec<Frame>,
    /// Bins that stood out before.
    pub bins: Vec<crate::finding::Bin>,
    /// What sessions differ in, where nothing could be named.
    pub level_note: Option<String>,
}

impl Searcher<'_> {
    /// The report and the next model.
    pub fn finish(mut self, ends: Ends) -> Result<Found, Error> {
        let Ends {
            base,
            after,
            after_whitener,
            free,
            held,
            level_note,
            ..
        } = &ends;
        let (all, settled) = self.estimates(after, after_whitener, free);
        let maker = self.maker(&settled);
        let already = after.effects.active.len() - self.owners.len();
        self.parameters(after, already, &all[free.len()..]);
        let base_parameters = self.base_parameters(free, &all);
        self.close(&ends, &settled, &maker, already);
        let training = gap::channels(base, after, self.training, &maker, self.used);
        let channels = gap::channels(base, after, held, &maker, self.used);
        let shown = self
            .steps
            .first()
            .map_or_else(|| CHANNEL_NAMES[1].0.to_owned(), |s| s.channel.clone());
        let one = channels
            .iter()
            .find(|c| c.channel == shown)
            .or(channels.first());
        let held_out = HeldOut {
            runs: held.iter().map(|f| f.name.clone()).collect(),
            gap_before: one.map_or(0.0, |c| c.before),
            gap_after: one.map_or(0.0, |c| c.after),
            unit: one.map_or(String::new(), |c| c.unit.clone()),
            channels,
        };
        let bins_after = gap::stand_out(
            after,
            after_whitener,
            self.training,
            0.05,
            self.options.seed,
        );
        let by_run = by_run(base, after, self.training, self.used);
        let clean = bins_after.iter().all(|b| b.p_value > 0.01);
        let stands_out = self.steps.is_empty() && self.stands_out(&ends, &bins_after, &maker);
        let verdict = self.verdict(stands_out, level_note.as_deref());
        let next_experiment = self.next_experiment(verdict, level_note.as_deref());
        let sentence = crate::procedure::sentence::sentence(
            verdict,
            &self.steps,
            &held_out,
            &next_experiment,
            &self.depends,
        );
        self.remarks.extend(self.depends.iter().cloned());
        let next =
            crate::evidence::runs::outcome::next_model::next_model(self.model, &settled, already);
        Ok(Found {
            report: Report {
                verdict,
                sentence,
                steps: self.steps,
                held_out,
                minimum_detectable: self.first.unwrap_or_default(),
                next_experiment,
                base: base_parameters,
                by_run,
                bins: ends.bins,
                bins_after,
                pictures: Vec::new(),
                clean,
                training,
                untestable: self.candidates.untestable.clone(),
                remarks: self.remarks,
                data: if self.data.segmented {
                    "one run, in segments"
                } else {
                    "runs"
                }
                .to_owned(),
                seed: self.options.seed,
                version: env!("CARGO_PKG_VERSION").to_owned(),
            },
            next,
        })
    }

    /// Sizes with their intervals, for the step that each belongs to.
    fn parameters(&mut self, after: &Chain, already: usize, estimates: &[Estimate]) {
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
                .map_or(0.0, |(from, to)| EDGES_M / (to - from).max(EDGES_M));
            let wider = |end: f64| {
                let way = end - est.value;
                est.value + way.signum() * way.hypot(1.96 * edges * est.value)
            };
            self.steps[self.owners[e - already]]
                .parameters
                .push(Fitted {
                    name,
                    value: est.value,
                    low: wider(est.low),
                    high: wider(est.high),
                    unit,
                });
        }
    }

    fn base_parameters(&self, free: &[usize], estimates: &[Estimate]) -> Vec<Fitted> {
        free.iter()
            .zip(estimates)
            .map(|(b, est)| {
                let scale = base_value(self.model, *b);
                Fitted {
                    name: BASE_NAMES[*b].to_owned(),
                    value: est.value * scale,
                    low: est.low * scale,
                    high: est.high * scale,
                    unit: if BASE_NAMES[*b].ends_with("rad") {
                        "N/rad"
                    } else {
                        ""
                    }
                    .to_owned(),
                }
            })
            .collect()
    }

    /// How much of what could be explained on the locked-away runs is.
    fn close(&mut self, ends: &Ends, settled: &Chain, maker: &TwinMaker, already: usize) {
        if self.steps.is_empty() || ends.whitener.count() == 0 || ends.held.is_empty() {
            return;
        }
        let locals: Vec<Candidate> = ends.after.effects.active[already..]
            .iter()
            .filter_map(|e| as_candidate(e, &self.candidates.local))
            .collect();
        let found_levels = self
            .candidates
            .levels
            .iter()
            .filter(|c| self.steps.iter().any(|s| s.effect == c.effect));
        let directions: Vec<Candidate> = self
            .candidates
            .regular
            .iter()
            .chain(found_levels)
            .chain(&locals)
            .cloned()
            .collect();
        let design = Design {
            chain: &ends.base,
            whitener: &ends.whitener,
            free_base: &ends.free,
            candidates: &directions,
            local: &[],
            windows: &[],
        };
        let closed = gap::explainable_closed(
            &design,
            settled,
            self.training,
            &ends.held,
            maker,
            self.options.seed,
        );
        for step in &mut self.steps {
            step.explainable_gap_closed = closed.clone();
            if step.channel == CHANNEL_NAMES[3].0 {
                // The forces do not show it: what is closed shows in the track's bins, of which these runs have few.
                step.explainable_gap_closed = track_closed(&ends.base, settled, &ends.held);
            }
        }
    }

    /// Whether bins stand out that no twin shows: noisy inputs make bins stand out in every run alike.
    fn stands_out(&self, ends: &Ends, bins: &[crate::finding::Bin], maker: &TwinMaker) -> bool {
        let strong = |bins: &[crate::finding::Bin]| bins.iter().any(|b| b.p_value <= 0.002);
        strong(bins)
            && (0..6).all(|k| {
                let twin: Vec<Frame> = self
                    .training
                    .iter()
                    .enumerate()
                    .map(|(i, frame)| maker.pair(frame, &ends.after, 5_000_011 + k, i).plus)
                    .collect();
                !strong(&gap::stand_out(
                    &ends.after,
                    &ends.after_whitener,
                    &twin,
                    0.05,
                    self.options.seed,
                ))
            })
    }

    pub fn verdict(&self, stands_out: bool, note: Option<&str>) -> Verdict {
        match self.steps.first() {
            Some(_) if !self.depends.is_empty() && self.steps.len() == 1 => Verdict::DependsOn,
            Some(step) if step.class.len() == 1 => Verdict::Named,
            Some(_) => Verdict::OneOf,
            None if note.is_some() => Verdict::NotIdentifiable,
            None if stands_out => Verdict::Located,
            None => Verdict::None,
        }
    }

    pub fn next_experiment(&self, verdict: Verdict, note: Option<&str>) -> String {
        match verdict {
            Verdict::NotIdentifiable => note.unwrap_or_default().to_owned(),
            Verdict::OneOf => {
                let mut what: Vec<String> = Vec::new();
                for step in self.steps.iter().filter(|s| s.class.len() > 1) {
                    for name in &step.class {
                        if let Some(info) = kufe_sled::effects::find(name).map(|e| e.info()) {
                            what.push(format!("{}: {}", name, info.decides));
                        }
                    }
                }
                what.dedup();
                what.join("; ")
            }
            Verdict::DependsOn => {
                "a survey of the track's slope with a stated deviation".to_owned()
            }
            Verdict::Named => "more runs in other conditions would narrow the parameter".to_owned(),
            Verdict::Located => {
                "runs in which the bins listed are visited with other variables changed".to_owned()
            }
            Verdict::None => {
                "more runs lower the smallest detectable sizes as one over the root of their number"
                    .to_owned()
            }
        }
    }
}

/// Share of the track channel's mean square, its scatter taken off, that is closed on other runs, without an error of its own.
fn track_closed(before: &Chain, after: &Chain, frames: &[Frame]) -> Interval {
    let of = |chain: &Chain| TrackChannel::new(chain, frames, &[]).map(|c| c.closure().powi(2));
    let value = match (of(before), of(after)) {
        (Some(b), Some(a)) if b > 0.0 => (1.0 - a / b).clamp(-1.0, 1.0),
        _ => 0.0,
    };
    Interval {
        value,
        low: -1.0,
        high: 1.0,
    }
}

fn as_candidate(active: &kufe_sled::effects::Active, locals: &[Candidate]) -> Option<Candidate> {
    let local = locals
        .iter()
        .find(|l| l.effect == active.effect_name() && active.values[l.parameter] != 0.0)?;
    let mut candidate = local.clone();
    candidate.values = active.values.clone();
    candidate.values[local.parameter] = 0.0;
    candidate.track = active.track.clone();
    Some(candidate)
}

fn base_value(model: &Model, b: usize) -> f64 {
    match b {
        1 => model.friction.front.mu_zeta,
        2 => model.friction.front.k_n_per_rad,
        3 => model.friction.rear.mu_zeta,
        4 => model.friction.rear.k_n_per_rad,
        _ => match model.friction.longitudinal.model() {
            Ok(kufe_friction::Longitudinal::Fixed(mu)) => mu,
            _ => 1.0,
        },
    }
}
