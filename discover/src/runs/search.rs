//! The search: fit, look, name, add, look again; at the end, once, the locked-away runs.

use kufe_sled::effects::{Effects, Kind, Level};
use kufe_sled::{Model, Vehicle};

use super::analysis::{Look, Seeing, best_windows, look};
use super::candidates::{Candidate, Candidates, list, unknown};
use super::chain::{BASE_NAMES, CHANNEL_NAMES, CHANNELS, Chain};
use super::corrected::noise_products;
use super::data::{Data, Frame};
use super::design::{Design, Products, windows};
use super::estimate::{ESTIMATED, Estimate, STATED, estimate};
use super::fit::{fit, free_base, residuals};
use super::levels::judge;
use super::track::TrackChannel;
use super::twins::TwinMaker;
use super::whiten::Whitener;
use super::{gap, lock};
use crate::report::{Detectable, Fitted, HeldOut, Interval, Report, Rival, Step, Verdict};
use crate::score::{Scores, cross_information};
use crate::{Error, Options};

/// What a search found, with the model that carries it.
pub struct Found {
    /// The report.
    pub report: Report,
    /// The model with the effects switched on and everything refitted.
    pub next: Model,
}

/// Largest p-value of a claim within runs; session claims and track claims have thresholds of their own, 0.05 in all.
const ALPHA: f64 = 0.02;
const ALPHA_LOCAL: f64 = 0.01;
const ALPHA_SESSIONS: f64 = 0.008;
const ALPHA_RUNS: f64 = 0.004;
const ALPHA_BEYOND: f64 = 0.005;
const ALPHA_TRACK: f64 = 0.0005;
/// The track channel is used where its runs agree within this many times what the sensors' noise scatters.
const AGREES_WITHIN: f64 = 3.0;
const MOST_STEPS: usize = 4;

/// Searches runs for what the model lacks.
///
/// # Errors
/// [`Error::TooFew`] for fewer than two runs or segments to train on, [`Error::BaseFit`], [`Error::Effect`].
pub fn search(
    data: &Data,
    model: &Model,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found, Error> {
    let mut own = Effects::from_tables(&model.effects)?;
    let trial = own.clone();
    // An effect of one's own without a value is a candidate, not a part of the model.
    own.active
        .retain(|e| !(matches!(e.kind, Kind::Custom(_)) && e.values[0] == 0.0));
    let mut chain = Chain {
        vehicle: Vehicle::new(model)?,
        base: [1.0; 5],
        effects: own,
        along_path: false,
        frozen: Vec::new(),
    };
    let locked = lock::lock(&data.frames, data.segmented);
    let training: Vec<Frame> = locked
        .training
        .iter()
        .map(|i| data.frames[*i].clone())
        .collect();
    let held: Vec<Frame> = locked
        .held
        .iter()
        .map(|i| data.frames[*i].clone())
        .collect();
    if training.len() < 2 {
        return Err(Error::TooFew {
            what: "runs to learn from, beside those locked away".to_owned(),
            found: training.len(),
            needed: 2,
        });
    }
    let mut remarks = data.remarks.clone();
    let used = channels_in_use(data, model, options, &mut remarks);
    if used[3] {
        chain.along_path = closes_along_path(&chain, &training);
    }
    let candidates = list(data, &trial, used[0]);
    let mut searcher = Searcher {
        data,
        model,
        options,
        progress,
        training: &training,
        used,
        candidates: &candidates,
        steps: Vec::new(),
        owners: Vec::new(),
        depends: Vec::new(),
        remarks,
        first: None,
        by_forces: Vec::new(),
    };
    (searcher.progress)("fitting the base model");
    let free = free_base(&chain, &training, used);
    let (base, whitener) = fit(&chain, &training, &free, used)?;
    if data.noise_estimated {
        let n = &data.noise;
        searcher.remarks.push(format!(
            "no [noise] in the model: estimated from the signals: accelerometer {:.3} m/s2, rates {:.5} rad/s, speed {:.4} m/s, slip {:.6} rad, steering {:.6} rad, roll split {:.6} rad; claims must hold from half to 1.6 times their bias",
            n.accel_mps2, n.rate_radps, n.speed_mps, n.slip_rad, n.steer_rad, n.roll_split_rad
        ));
    }
    let bins = gap::stand_out(&base, &whitener, &training, 0.05, options.seed);
    let (after, level_note) = searcher.steps_from(base.clone(), &free)?;
    let (after, after_whitener) = searcher.backward(after, &free)?;
    (searcher.progress)("opening the locked-away runs");
    searcher.finish(
        &base,
        &whitener,
        after,
        &after_whitener,
        &free,
        &held,
        bins,
        level_note,
    )
}

/// Whether the track channel closes better with the slope along the sled's way than along its axis.
fn closes_along_path(chain: &Chain, frames: &[Frame]) -> bool {
    let closure = |along_path: bool| {
        let mut chain = chain.clone();
        chain.along_path = along_path;
        TrackChannel::new(&chain, frames, &[]).map_or(f64::INFINITY, |c| c.closure())
    };
    closure(true) < closure(false)
}

fn channels_in_use(
    data: &Data,
    model: &Model,
    options: &Options,
    remarks: &mut Vec<String>,
) -> [bool; CHANNELS] {
    let silent = model.sled.cda_m2 == 0.0
        && matches!(model.friction.longitudinal.model(), Ok(kufe_friction::Longitudinal::Fixed(mu)) if mu <= 1e-9);
    let has_along = data
        .available
        .contains(&kufe_sled::effects::Column::LongitudinalAcceleration);
    let along = has_along && !silent && options.longitudinal;
    if silent {
        remarks.push(
            "the model has no friction and no drag along: the longitudinal channel is left out"
                .to_owned(),
        );
    }
    let surveyed = data.frames.iter().all(|f| f.slope.len() == f.len());
    let track = along && surveyed;
    if along {
        remarks.push("the longitudinal residual uses the specific force a_x, which gravity does not enter; the speed's derivative enters the track channel alone".to_owned());
    }
    [along, options.lateral, options.lateral, track]
}

struct Searcher<'a> {
    data: &'a Data,
    model: &'a Model,
    options: &'a Options,
    progress: &'a (dyn Fn(&str) + Sync),
    training: &'a [Frame],
    used: [bool; CHANNELS],
    candidates: &'a Candidates,
    steps: Vec<Step>,
    /// The step of each effect that was added.
    owners: Vec<usize>,
    depends: Vec<String>,
    remarks: Vec<String>,
    first: Option<Vec<Detectable>>,
    /// What the forces alone say of each candidate's size, with its standard error.
    by_forces: Vec<(Candidate, f64, f64)>,
}

/// What a look leads to.
struct Pick {
    candidate: Candidate,
    size: f64,
    class: Vec<String>,
    rivals: Vec<Rival>,
    p_value: f64,
    place: String,
    channel: usize,
    /// T that noisy inputs alone produce.
    bias_t: Option<f64>,
    /// Standard error of a size that comes from the track channel.
    track_error: Option<f64>,
}

/// Where a search stands: the model so far and what was made for it.
struct Stand<'a> {
    chain: &'a Chain,
    whitener: &'a Whitener,
    free: &'a [usize],
    maker: &'a TwinMaker,
}

impl<'a> Stand<'a> {
    fn design(&self, candidates: &'a [Candidate]) -> Design<'a> {
        Design {
            chain: self.chain,
            whitener: self.whitener,
            free_base: self.free,
            candidates,
            local: &[],
            windows: &[],
        }
    }
}

impl Searcher<'_> {
    fn maker(&self, chain: &Chain) -> TwinMaker {
        TwinMaker::new(
            self.training,
            chain,
            self.data.noise,
            self.used,
            self.options.seed,
        )
    }

    /// After a first name the next ones are held to half of the chance of an error.
    fn share(&self) -> f64 {
        if self.steps.is_empty() { 1.0 } else { 0.5 }
    }

    fn look_options(&self) -> Look {
        let share = self.share();
        Look {
            pairs: self.options.twins.div_ceil(40).max(1),
            flips: self.options.flips,
            alpha: share * ALPHA,
            alpha_local: share * ALPHA_LOCAL,
            alpha_beyond: share * ALPHA_BEYOND,
            trust: if self.data.noise_estimated {
                [0.5, 1.6]
            } else {
                [0.75, 1.3]
            },
            seed: self.options.seed,
        }
    }

    /// Adds effects one by one until nothing more stands out.
    fn steps_from(
        &mut self,
        base: Chain,
        free: &[usize],
    ) -> Result<(Chain, Option<String>), Error> {
        let mut chain = base;
        let mut note = None;
        for number in 0..=MOST_STEPS {
            (self.progress)(&format!("look {}", number + 1));
            let whitener = Whitener::estimate(&residuals(&chain, self.training), self.used);
            let maker = self.maker(&chain);
            let at = Stand {
                chain: &chain,
                whitener: &whitener,
                free,
                maker: &maker,
            };
            let pick = self
                .within_runs(&at)
                .or_else(|| self.between_runs(&at, &mut note))
                .or_else(|| self.on_the_track(&chain, &maker));
            let Some(pick) = pick else { break };
            if number == MOST_STEPS {
                self.remarks.push(format!(
                    "after {MOST_STEPS} effects {} still stands out",
                    pick.candidate.effect
                ));
                break;
            }
            (self.progress)(&format!("adding {}", pick.candidate.label()));
            if pick.candidate.carrier.is_some() {
                self.tell_column(&chain, pick);
                break;
            }
            if let Some(bias) = pick.bias_t.filter(|b| b.abs() > 1.0) {
                self.remarks.push(format!(
                    "{}: noisy inputs alone would show T = {bias:.1}; it was taken off",
                    pick.candidate.effect
                ));
            }
            let mut active = pick.candidate.active(pick.size);
            let same = chain
                .effects
                .active
                .iter()
                .filter(|e| e.effect_name() == active.name)
                .count();
            if same > 0 {
                active.name = format!("{}@{}", active.name, same + 1);
            }
            let before = gap_of(&chain, self.training, pick.channel);
            let mut next = chain.with(active);
            let mut parameters = Vec::new();
            if let Some(error) = pick.track_error {
                // The forces say nothing of a slope: the track channel's own size stands.
                next.frozen
                    .extend(next.effects.active.last().map(|e| e.name.clone()));
                parameters.push(Fitted {
                    name: pick.candidate.key.clone(),
                    value: pick.size,
                    low: pick.size - 1.96 * error,
                    high: pick.size + 1.96 * error,
                    unit: pick.candidate.unit.clone(),
                });
            }
            let (next, _) = fit(&next, self.training, free, self.used)?;
            let after = gap_of(&next, self.training, pick.channel);
            chain = next;
            // Another stretch or another amplitude of an effect belongs to the same step.
            let known = self
                .steps
                .iter()
                .position(|s| s.effect == pick.candidate.effect);
            if let Some(known) = known {
                let step = &mut self.steps[known];
                if pick.candidate.track.is_some() {
                    step.place = format!("{}; {}", step.place, pick.place);
                }
                step.gap_after = after;
                self.owners.push(known);
                continue;
            }
            self.owners.push(self.steps.len());
            self.steps.push(Step {
                effect: pick.candidate.effect.clone(),
                class: pick.class,
                channel: CHANNEL_NAMES[pick.channel].0.to_owned(),
                place: pick.place,
                p_value: pick.p_value,
                parameters,
                gap_before: before,
                gap_after: after,
                unit: CHANNEL_NAMES[pick.channel].1.to_owned(),
                explainable_gap_closed: Interval {
                    value: 0.0,
                    low: 0.0,
                    high: 0.0,
                },
                rivals: pick.rivals,
            });
        }
        Ok((chain, note))
    }

    /// A dependence on a column that no simulation knows ends the search: nothing can be switched on for it.
    fn tell_column(&mut self, chain: &Chain, pick: Pick) {
        let gap = gap_of(chain, self.training, pick.channel);
        self.remarks.push(format!(
            "{}: the model has no such column, so that nothing was switched on",
            pick.candidate.effect
        ));
        self.steps.push(Step {
            effect: pick.candidate.effect,
            class: pick.class,
            channel: CHANNEL_NAMES[pick.channel].0.to_owned(),
            place: pick.place,
            p_value: pick.p_value,
            parameters: Vec::new(),
            gap_before: gap,
            gap_after: gap,
            unit: CHANNEL_NAMES[pick.channel].1.to_owned(),
            explainable_gap_closed: Interval {
                value: 0.0,
                low: 0.0,
                high: 0.0,
            },
            rivals: pick.rivals,
        });
    }

    fn within_runs(&mut self, at: &Stand) -> Option<Pick> {
        if at.whitener.count() == 0 {
            return None;
        }
        let mut regular = self.fresh(at.chain, &self.candidates.regular);
        regular.extend(unknown(self.data, self.model.sled.mass_kg, self.used[0]));
        // A person's own effect may bear such a name, too.
        regular.sort_by_key(Candidate::is_unknown);
        let all_windows = windows(self.training, self.candidates.local.len());
        let design = Design {
            local: &self.candidates.local,
            windows: &all_windows,
            ..at.design(&regular)
        };
        let options = self.look_options();
        let seeing = look(&design, self.training, at.maker, &options);
        if self.first.is_none() {
            let named = regular.iter().filter(|c| !c.is_unknown()).count();
            self.first = Some(detectable(&seeing, &regular[..named]));
        }
        self.by_forces = regular
            .iter()
            .zip(&seeing.seen)
            .filter(|(_, seen)| seen.usable && seen.left > 0.05)
            .map(|(c, seen)| (c.clone(), seen.size, seen.error))
            .collect();
        let places = best_windows(&seeing, &self.candidates.local, &all_windows, regular.len());
        self.choose(at, &seeing, &regular, &places, &options)
    }

    /// Candidates that are not already part of the chain.
    fn fresh(&self, chain: &Chain, list: &[Candidate]) -> Vec<Candidate> {
        list.iter()
            .filter(|c| {
                !chain.effects.active.iter().any(|e| {
                    e.effect_name() == c.effect
                        && e.track == c.track
                        && e.values[c.parameter] != 0.0
                })
            })
            .cloned()
            .collect()
    }

    fn choose(
        &self,
        at: &Stand,
        seeing: &Seeing,
        regular: &[Candidate],
        places: &[(Candidate, usize)],
        options: &Look,
    ) -> Option<Pick> {
        let gain = |c: usize| seeing.seen[c].gain;
        let alpha_of = |candidate: &Candidate| match (&candidate.track, candidate.is_unknown()) {
            (_, true) => options.alpha_beyond,
            (Some(_), _) => options.alpha_local,
            _ => options.alpha,
        };
        let most = (0..regular.len())
            .map(|c| (&regular[c], c))
            .chain(places.iter().map(|(candidate, c)| (candidate, *c)))
            .filter(|(candidate, c)| seeing.claimable(*c, candidate, alpha_of(candidate)))
            .map(|(_, c)| gain(c))
            .fold(0.0, f64::max);
        // Windows that compete, with edges found to a few metres, are judged as ordinary candidates beside all others.
        let close: Vec<(Candidate, usize)> = places
            .iter()
            .filter(|(_, c)| most > 0.0 && gain(*c) > 0.3 * most)
            .map(|(candidate, c)| (self.refined(at, candidate), *c))
            .collect();
        let list: Vec<Candidate> = regular
            .iter()
            .chain(close.iter().map(|(candidate, _)| candidate))
            .cloned()
            .collect();
        let mut together = Seeing {
            seen: seeing.seen[..regular.len()].to_vec(),
            u: seeing.u.rows(0, regular.len()).into_owned(),
            cross: seeing.cross.clone(),
        };
        if !close.is_empty() {
            let design = at.design(&list);
            let noise = noise_products(&design, self.training, at.maker, 0);
            let grams: Vec<_> = design
                .products(self.training)
                .iter()
                .zip(&noise)
                .map(|(p, d)| p.corrected(d, 1.0))
                .collect();
            let scores = Scores::new(&grams, design.fitted());
            together.cross = cross_information(&grams, design.fitted());
            let rows = together.u.nrows();
            together.u = together.u.insert_rows(rows, close.len(), 0.0);
            for (k, (candidate, c)) in close.iter().enumerate() {
                together
                    .u
                    .row_mut(rows + k)
                    .copy_from(&scores.u.row(rows + k));
                let information = scores.total_information(rows + k).max(1e-300);
                let sum: f64 = scores.u.row(rows + k).sum();
                let mut seen = seeing.seen[*c].clone();
                seen.size = sum / information * candidate.typical;
                seen.gain = sum * sum / information;
                together.seen.push(seen);
            }
        }
        let best = |wanted: bool| {
            (0..list.len())
                .filter(|c| list[*c].is_unknown() == wanted)
                .filter(|c| together.claimable(*c, &list[*c], alpha_of(&list[*c])))
                .max_by(|a, b| together.seen[*a].gain.total_cmp(&together.seen[*b].gain))
        };
        // What the catalogue knows comes first, unless a column beyond it takes all that the name explains and more.
        let mut named = match (best(false), best(true)) {
            (Some(known), Some(other)) => {
                let more = together.seen[other].gain > together.seen[known].gain;
                let t = |a: usize, b: usize| together.beyond(a, b) * together.seen[a].t.signum();
                if more && t(known, other) < 2.0 && t(other, known) > 3.0 {
                    other
                } else {
                    known
                }
            }
            (known, other) => known.or(other)?,
        };
        let (mut class, mut rivals) = self.rivals(&together, &list, named);
        // Of a class of places, the effect that already acts elsewhere is the simpler account.
        let known = (regular.len()..list.len()).find(|c| {
            list[named].track.is_some()
                && *c != named
                && class.contains(&list[*c].effect)
                && self.steps.iter().any(|s| s.effect == list[*c].effect)
        });
        if let Some(known) = known {
            named = known;
            (class, rivals) = self.rivals(&together, &list, named);
        }
        let seen = &together.seen[named];
        Some(Pick {
            place: self.place_of(&list[named], at),
            channel: self.strongest_channel(at.chain, &list[named], seen.size),
            candidate: list[named].clone(),
            size: seen.size,
            class,
            rivals,
            p_value: seen.p_value,
            bias_t: Some(seen.bias_t),
            track_error: None,
        })
    }

    /// A window with its edges moved to where it explains most.
    fn refined(&self, at: &Stand, candidate: &Candidate) -> Candidate {
        const MOVES: [f64; 7] = [-7.5, -5.0, -2.5, 0.0, 2.5, 5.0, 7.5];
        let (Some(track), Some((from, to))) = (&candidate.track, candidate.window()) else {
            return candidate.clone();
        };
        let there: Vec<Frame> = self
            .training
            .iter()
            .filter(|f| f.track == *track)
            .cloned()
            .collect();
        let trials: Vec<Candidate> = MOVES
            .iter()
            .flat_map(|a| MOVES.iter().map(move |b| (from + a, to + b)))
            .filter(|(a, b)| b - a >= 5.0)
            .map(|(a, b)| candidate.within(track, a, b))
            .collect();
        let design = at.design(&trials);
        let grams: Vec<_> = design
            .products(&there)
            .iter()
            .map(Products::plain)
            .collect();
        let scores = Scores::new(&grams, design.fitted());
        let gain = |c: usize| -> f64 {
            scores.u.row(c).sum().powi(2) / scores.total_information(c).max(1e-300)
        };
        (0..trials.len())
            .max_by(|a, b| gain(*a).total_cmp(&gain(*b)))
            .map_or_else(|| candidate.clone(), |c| trials[c].clone())
    }

    /// The class: rivals that the named effect does not stand out beside.
    fn rivals(
        &self,
        seeing: &Seeing,
        list: &[Candidate],
        named: usize,
    ) -> (Vec<String>, Vec<Rival>) {
        let runs = self.training.len() as f64;
        let needed = 2.0 + 2.0 / runs.sqrt();
        let name = &list[named].effect;
        let mut class = vec![name.clone()];
        let mut rivals: Vec<Rival> = Vec::new();
        for (j, candidate) in list.iter().enumerate() {
            let s = &seeing.seen[j];
            let stranger = candidate.is_unknown() && !list[named].is_unknown();
            if candidate.effect == *name || stranger || !s.usable || s.t.abs() < 1.5 {
                continue;
            }
            let beyond = seeing.beyond(named, j);
            let sign = seeing.seen[named].t.signum();
            let correlation = seeing.correlation(named, j);
            let possible = (candidate.low..=candidate.high).contains(&s.size);
            let twin = correlation.abs() > 0.995;
            let in_class = possible
                && (twin || (beyond * sign < needed && s.gain > 0.3 * seeing.seen[named].gain));
            if in_class && !class.contains(&candidate.effect) {
                class.push(candidate.effect.clone());
            }
            rivals.push(Rival {
                effect: candidate.effect.clone(),
                parameter: candidate.key.clone(),
                size: s.size,
                unit: candidate.unit.clone(),
                t: s.t,
                gain: s.gain,
                correlation,
                t_of_named_beyond: beyond,
                in_class,
                decides: candidate.decides.clone(),
            });
        }
        rivals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        rivals.truncate(12);
        (class, rivals)
    }

    fn place_of(&self, candidate: &Candidate, stand: &Stand) -> String {
        let on = candidate
            .track
            .as_ref()
            .map_or(String::new(), |t| format!(" on track {t}"));
        if let (Some(_), Some((from, to))) = (&candidate.track, candidate.window()) {
            return format!("s {from:.0}-{to:.0} m{on}");
        }
        let form = match &candidate.kind {
            Kind::Custom(custom) => {
                format!("; form {} on {:?}", custom.text, custom.channel).to_lowercase()
            }
            Kind::Catalogue(_) => String::new(),
        };
        if candidate.is_unknown() {
            return format!("all runs{form}");
        }
        // The share of samples that carries half of the effect tells where it acts.
        let Some(frame) = self.training.first() else {
            return "all runs".to_owned();
        };
        let rest = stand.chain.raw(frame);
        let moved = stand
            .chain
            .with(candidate.active(candidate.typical))
            .raw(frame);
        let mut size: Vec<(f64, usize)> = (0..frame.len())
            .map(|i| {
                (
                    (0..3)
                        .map(|c| ((rest[c][i] - moved[c][i]) / stand.whitener.sd[c]).powi(2))
                        .sum::<f64>(),
                    i,
                )
            })
            .collect();
        let total: f64 = size.iter().map(|x| x.0).sum();
        size.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (mut sum, mut count, mut speed, mut load) = (0.0, 0, 0.0, 0.0);
        for (x, i) in &size {
            if sum > 0.5 * total {
                break;
            }
            sum += x;
            count += 1;
            speed += frame.v[*i];
            load += frame.acceleration[2][*i];
        }
        let count_f = f64::from(count.max(1));
        format!(
            "all runs{on}; half of it in {:.0} % of the samples, around v = {:.1} m/s and a_z = {:.1} m/s2",
            100.0 * count_f / frame.len() as f64,
            speed / count_f,
            load / count_f
        )
    }

    fn strongest_channel(&self, chain: &Chain, candidate: &Candidate, size: f64) -> usize {
        let mut energy = [0.0; CHANNELS];
        for frame in self.training.iter().take(4) {
            let rest = chain.residuals(frame);
            let moved = chain.with(candidate.active(size)).residuals(frame);
            for c in (0..CHANNELS).filter(|c| self.used[*c]) {
                let scale = scale_of(&rest[c]);
                energy[c] += rest[c]
                    .iter()
                    .zip(&moved[c])
                    .map(|(a, b)| ((a - b) / scale).powi(2))
                    .sum::<f64>();
            }
        }
        (0..CHANNELS)
            .max_by(|a, b| energy[*a].total_cmp(&energy[*b]))
            .unwrap_or(1)
    }

    fn between_runs(&mut self, at: &Stand, note: &mut Option<String>) -> Option<Pick> {
        let list = self.fresh(at.chain, &self.candidates.levels);
        if list.is_empty() || at.whitener.count() == 0 {
            return None;
        }
        let design = at.design(&list);
        let share = self.share();
        let alpha_of = |candidate: &Candidate| match candidate.level {
            Level::Run => share * ALPHA_RUNS,
            _ => share * ALPHA_SESSIONS,
        };
        let levels = judge(
            &design,
            self.training,
            &list,
            at.maker,
            ALPHA_SESSIONS,
            self.options.seed,
        );
        let best = (0..list.len())
            .filter(|c| {
                let s = &levels.seen[*c];
                s.p_value <= alpha_of(&list[*c]) && (list[*c].low..=list[*c].high).contains(&s.size)
            })
            .max_by(|a, b| levels.seen[*a].gain.total_cmp(&levels.seen[*b].gain));
        let Some(named) = best else {
            let differ = levels.sessions_differ.iter().copied().fold(1.0, f64::min);
            let untestable = list
                .iter()
                .zip(&levels.seen)
                .filter(|(_, s)| !s.testable)
                .count();
            if differ < 0.001 && untestable > 0 && note.is_none() {
                *note = Some(format!(
                    "sessions differ (p = {differ:.1e}), but {} sessions are too few to say with what: at least 5 at spread temperatures and humidities are needed",
                    levels.sessions
                ));
            }
            return None;
        };
        let mut class = vec![list[named].effect.clone()];
        let mut rivals = Vec::new();
        for j in (0..list.len()).filter(|j| *j != named) {
            let beyond = levels.beyond(named, j);
            let s = &levels.seen[j];
            let in_class = beyond.abs() < 2.5 && s.gain > 0.5 * levels.seen[named].gain;
            if in_class {
                class.push(list[j].effect.clone());
            }
            rivals.push(Rival {
                effect: list[j].effect.clone(),
                parameter: list[j].key.clone(),
                size: s.size,
                unit: list[j].unit.clone(),
                t: s.size / s.error.max(1e-300),
                gain: s.gain,
                correlation: s.correlation,
                t_of_named_beyond: beyond.clamp(-1e6, 1e6),
                in_class,
                decides: list[j].decides.clone(),
            });
        }
        let seen = &levels.seen[named];
        Some(Pick {
            place: "a level from session to session".to_owned(),
            channel: self.strongest_channel(at.chain, &list[named], seen.size),
            candidate: list[named].clone(),
            size: seen.size,
            class,
            rivals,
            p_value: seen.p_value,
            bias_t: None,
            track_error: None,
        })
    }

    fn on_the_track(&mut self, chain: &Chain, maker: &TwinMaker) -> Option<Pick> {
        if !self.used[3] || !chain.frozen.is_empty() {
            return None;
        }
        let list: Vec<Candidate> = self
            .fresh(chain, &self.candidates.track)
            .into_iter()
            .filter(|c| c.effect != "track-profile")
            .collect();
        let channel = TrackChannel::new(chain, self.training, &list)?;
        let stated = self.model.survey.map(|s| s.slope_sd_rad);
        let sd = stated.unwrap_or(0.002);
        if stated.is_none() && self.steps.is_empty() {
            self.remarks.push(
                "no [survey] in the model: a slope deviation of 0.002 rad is assumed".to_owned(),
            );
        }
        let quiet = maker.sensors_only();
        let twins: Vec<Frame> = self
            .training
            .iter()
            .enumerate()
            .map(|(i, frame)| quiet.pair(frame, chain, 5_000_003, i).plus)
            .collect();
        let expected = TrackChannel::new(chain, &twins, &[])?.scatter();
        if channel.scatter() > AGREES_WITHIN * expected {
            let told = format!(
                "from run to run the speed's derivative, the accelerometer and the track's slope disagree by {:.3} m/s2, the sensors' noise explains {expected:.3}: the track channel is not used, and slope, track-profile and the accelerometer's pitch are not judged",
                channel.scatter()
            );
            if self.steps.is_empty() {
                self.remarks.push(told);
            }
            return None;
        }
        // A sensor's fault also shows in the forces: what they contradict is no candidate.
        let agrees = |c: usize| {
            let seen = channel.judge(c, sd);
            let forces = self
                .by_forces
                .iter()
                .find(|(known, ..)| known.effect == list[c].effect && known.key == list[c].key);
            forces.is_none_or(|(_, size, error)| {
                (seen.size - size).abs() < 3.0 * seen.error.hypot(*error)
            })
        };
        let able: Vec<usize> = (0..list.len()).filter(|c| agrees(*c)).collect();
        let at = |factor: f64| -> Option<usize> {
            able.iter()
                .copied()
                .filter(|c| channel.judge(*c, sd * factor).p_value <= ALPHA_TRACK)
                .max_by(|a, b| {
                    let z = |c: usize| {
                        (channel.judge(c, sd * factor).size / channel.judge(c, sd * factor).error)
                            .abs()
                    };
                    z(*a).total_cmp(&z(*b))
                })
        };
        if let Some(named) = at(1.0) {
            let seen = channel.judge(named, sd);
            let mut class = vec![list[named].effect.clone()];
            for j in able.iter().copied().filter(|j| *j != named) {
                if channel.beyond(named, j, sd).abs() < 2.0 {
                    class.push(list[j].effect.clone());
                }
            }
            if at(2.0).is_none() {
                self.depends.push(format!(
                    "{} stands out at the stated survey deviation but not at twice it",
                    list[named].effect
                ));
            }
            return Some(Pick {
                place: "all runs".to_owned(),
                channel: 3,
                candidate: list[named].clone(),
                size: seen.size,
                class,
                rivals: Vec::new(),
                p_value: seen.p_value,
                bias_t: None,
                track_error: Some(seen.error),
            });
        }
        let profile = self
            .candidates
            .track
            .iter()
            .find(|c| c.effect == "track-profile")?;
        if chain
            .effects
            .active
            .iter()
            .any(|e| e.effect_name() == "track-profile")
        {
            return None;
        }
        let (p, track, from, to, slope, needed_sd) = channel.profile(sd);
        if p > ALPHA_TRACK {
            if channel.profile(0.5 * sd).0 <= ALPHA_TRACK && needed_sd > sd {
                self.remarks.push(format!("the track's profile would be off if its survey were twice as good as stated; {needed_sd:.5} rad fits it"));
            }
            return None;
        }
        if channel.profile(2.0 * sd).0 > ALPHA_TRACK {
            self.depends.push(format!(
                "the track's profile departs from its survey at the stated deviation of {sd:.5} rad, not at twice it; {needed_sd:.5} rad fits it"
            ));
        }
        let candidate = profile.within(&track, from, to);
        Some(Pick {
            place: format!(
                "s {from:.0}-{to:.0} m on track {track} most; the whole profile departs by {needed_sd:.5} rad"
            ),
            channel: 3,
            candidate,
            size: slope,
            class: vec!["track-profile".to_owned()],
            rivals: Vec::new(),
            p_value: p,
            bias_t: None,
            track_error: Some(needed_sd),
        })
    }

    /// Leaves out again what the others have made superfluous.
    fn backward(&mut self, mut chain: Chain, free: &[usize]) -> Result<(Chain, Whitener), Error> {
        let already = chain.effects.active.len() - self.owners.len();
        let mut step = 0;
        while self.steps.len() > 1 && step < self.steps.len() {
            let whitener = Whitener::estimate(&residuals(&chain, self.training), self.used);
            let estimates = self
                .estimates(&chain, &whitener, free)
                .0
                .split_off(free.len());
            let weak = chain
                .free()
                .iter()
                .zip(&estimates)
                .filter(|((e, _), _)| *e >= already && self.owners[*e - already] == step)
                .all(|(_, est)| (est.value / est.error.max(1e-300)).abs() < 1.5);
            if weak && self.owners.contains(&step) && self.steps[step].channel != "track" {
                self.remarks.push(format!(
                    "{} became superfluous once the others were there and was removed",
                    self.steps[step].effect
                ));
                let owners = std::mem::take(&mut self.owners);
                let mut place = 0;
                chain.effects.active.retain(|_| {
                    place += 1;
                    place <= already || owners[place - 1 - already] != step
                });
                self.owners = owners
                    .into_iter()
                    .filter(|o| *o != step)
                    .map(|o| o - usize::from(o > step))
                    .collect();
                self.steps.remove(step);
                chain = fit(&chain, self.training, free, self.used)?.0;
            } else {
                step += 1;
            }
        }
        fit(&chain, self.training, free, self.used)
    }

    /// Base parameters (as multipliers) first, then the effects' amplitudes, and the chain that holds them.
    fn estimates(
        &self,
        chain: &Chain,
        whitener: &Whitener,
        free: &[usize],
    ) -> (Vec<Estimate>, Chain) {
        // Where the noise is only estimated its bias is not known well enough to be taken off.
        let (trust, settle) = if self.data.noise_estimated {
            (ESTIMATED, false)
        } else {
            (STATED, true)
        };
        let maker = self.maker(chain);
        estimate(chain, whitener, self.training, free, &maker, trust, settle)
    }

    #[allow(clippy::too_many_arguments)]
    fn finish(
        mut self,
        base: &Chain,
        whitener: &Whitener,
        after: Chain,
        after_whitener: &Whitener,
        free: &[usize],
        held: &[Frame],
        bins: Vec<crate::report::Bin>,
        level_note: Option<String>,
    ) -> Result<Found, Error> {
        let (all, settled) = self.estimates(&after, after_whitener, free);
        let maker = self.maker(&settled);
        let already = after.effects.active.len() - self.owners.len();
        for ((e, q), est) in after.free().into_iter().zip(&all[free.len()..]) {
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
            self.steps[self.owners[e - already]]
                .parameters
                .push(Fitted {
                    name,
                    value: est.value,
                    low: est.low,
                    high: est.high,
                    unit,
                });
        }
        let base_parameters = free
            .iter()
            .zip(&all)
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
            .collect();
        let regular = &self.candidates.regular;
        let locals: Vec<Candidate> = after.effects.active[already..]
            .iter()
            .filter_map(|e| as_candidate(e, &self.candidates.local))
            .collect();
        let found_levels = self
            .candidates
            .levels
            .iter()
            .filter(|c| self.steps.iter().any(|s| s.effect == c.effect));
        let directions: Vec<Candidate> = regular
            .iter()
            .chain(found_levels)
            .chain(&locals)
            .cloned()
            .collect();
        if !self.steps.is_empty() && whitener.count() > 0 && !held.is_empty() {
            let design = Design {
                chain: base,
                whitener,
                free_base: free,
                candidates: &directions,
                local: &[],
                windows: &[],
            };
            let closed = gap::explainable_closed(
                &design,
                &settled,
                self.training,
                held,
                &maker,
                self.options.seed,
            );
            for step in &mut self.steps {
                step.explainable_gap_closed = closed.clone();
                if step.channel == CHANNEL_NAMES[3].0 {
                    // The forces do not show it: what is closed shows in the track's bins, of which these runs have few.
                    step.explainable_gap_closed = track_closed(base, &settled, held);
                }
            }
        }
        let training = gap::channels(base, &after, self.training, &maker, self.used);
        let channels = gap::channels(base, &after, held, &maker, self.used);
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
            &after,
            after_whitener,
            self.training,
            0.05,
            self.options.seed,
        );
        let clean = bins_after.iter().all(|b| b.p_value > 0.01);
        // Noisy inputs make bins stand out in every run alike; a place counts only where twins show none.
        let strong = |bins: &[crate::report::Bin]| bins.iter().any(|b| b.p_value <= 0.002);
        let stands_out = self.steps.is_empty() && strong(&bins_after) && {
            (0..6).all(|k| {
                let twin: Vec<Frame> = self
                    .training
                    .iter()
                    .enumerate()
                    .map(|(i, frame)| maker.pair(frame, &after, 5_000_011 + k, i).plus)
                    .collect();
                !strong(&gap::stand_out(
                    &after,
                    after_whitener,
                    &twin,
                    0.05,
                    self.options.seed,
                ))
            })
        };
        let verdict = self.verdict(stands_out, level_note.as_deref());
        let next_experiment = self.next_experiment(verdict, level_note.as_deref());
        let sentence = crate::sentence::sentence(
            verdict,
            &self.steps,
            &held_out,
            &next_experiment,
            &self.depends,
        );
        self.remarks.extend(self.depends.iter().cloned());
        let next = super::next::next_model(self.model, &settled, already);
        Ok(Found {
            report: Report {
                verdict,
                sentence,
                steps: self.steps,
                held_out,
                minimum_detectable: self.first.unwrap_or_default(),
                next_experiment,
                base: base_parameters,
                bins,
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

    fn verdict(&self, stands_out: bool, note: Option<&str>) -> Verdict {
        match self.steps.first() {
            Some(_) if !self.depends.is_empty() && self.steps.len() == 1 => Verdict::DependsOn,
            Some(step) if step.class.len() == 1 => Verdict::Named,
            Some(_) => Verdict::OneOf,
            None if note.is_some() => Verdict::NotIdentifiable,
            None if stands_out => Verdict::Located,
            None => Verdict::None,
        }
    }

    fn next_experiment(&self, verdict: Verdict, note: Option<&str>) -> String {
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

fn scale_of(rows: &[f64]) -> f64 {
    (rows.iter().map(|x| x * x).sum::<f64>() / rows.len().max(1) as f64)
        .sqrt()
        .max(1e-300)
}

fn gap_of(chain: &Chain, frames: &[Frame], channel: usize) -> f64 {
    let rows: Vec<f64> = residuals(chain, frames)
        .into_iter()
        .flat_map(|r| r[channel].clone())
        .collect();
    scale_of(&rows)
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

fn detectable(seeing: &Seeing, list: &[Candidate]) -> Vec<Detectable> {
    list.iter()
        .enumerate()
        .filter(|(c, _)| seeing.seen[*c].usable)
        .map(|(c, candidate)| {
            let like = (0..list.len())
                .filter(|j| list[*j].effect != candidate.effect && seeing.seen[*j].usable)
                .max_by(|a, b| {
                    seeing
                        .correlation(c, *a)
                        .abs()
                        .total_cmp(&seeing.correlation(c, *b).abs())
                });
            Detectable {
                effect: candidate.effect.clone(),
                parameter: candidate.key.clone(),
                size: seeing.seen[c].detectable,
                unit: candidate.unit.clone(),
                left_after_refit: seeing.seen[c].left,
                most_like: like.map_or(String::new(), |j| list[j].effect.clone()),
                correlation: like.map_or(0.0, |j| seeing.correlation(c, j)),
            }
        })
        .collect()
}
