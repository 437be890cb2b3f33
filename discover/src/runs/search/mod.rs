//! The search: fit, look, name, add, look again; at the end, once, the locked-away runs.

mod backward;
mod between;
mod detectable;
mod finish;
mod on_track;
mod place;
mod rivals;
mod within;

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

/// Largest p-values of claims, by where they are made: within runs, in windows of distance, between sessions (twice:
/// friction and grip), between runs, beyond the catalogue, on the track. Together they leave a null a chance of about
/// 0.02 of being claimed: what a model lacks usually stands far beyond these, and chance does not.
const ALPHA: f64 = 0.005;
const ALPHA_LOCAL: f64 = 0.005;
const ALPHA_SESSIONS: f64 = 0.002;
const ALPHA_RUNS: f64 = 0.002;
const ALPHA_BEYOND: f64 = 0.001;
const ALPHA_TRACK: f64 = 0.0005;
/// The track channel is used where its runs agree within this many times what the sensors' noise scatters.
const AGREES_WITHIN: f64 = 3.0;
const MOST_STEPS: usize = 4;
/// Looks in all: several amplitudes or places of one effect belong to one step.
const MOST_LOOKS: usize = 8;

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
    searcher.finish(finish::Ends {
        base,
        whitener,
        after,
        after_whitener,
        free,
        held,
        bins,
        level_note,
    })
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
        for number in 0..=MOST_LOOKS {
            (self.progress)(&format!("look {}", number + 1));
            let whitener = Whitener::estimate(&residuals(&chain, self.training), self.used);
            let maker = self.maker(&chain);
            let at = Stand {
                chain: &chain,
                whitener: &whitener,
                free,
                maker: &maker,
            };
            let track = self.surveyed(&chain, &maker);
            let pick = self
                .within_runs(&at, track.as_ref())
                .or_else(|| self.between_runs(&at, &mut note))
                .or_else(|| self.on_the_track(&chain, track.as_ref()?));
            let Some(pick) = pick else { break };
            let known = self
                .steps
                .iter()
                .position(|s| s.effect == pick.candidate.effect);
            if number == MOST_LOOKS || known.is_none() && self.steps.len() == MOST_STEPS {
                self.remarks.push(format!(
                    "after {} effects {} still stands out",
                    self.steps.len(),
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
            self.steps.push(step(pick, parameters, [before, after]));
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
        self.steps.push(step(pick, Vec::new(), [gap, gap]));
    }
}

/// What a pick adds to the report; how much of the gap it closes is told once the search has ended.
fn step(pick: Pick, parameters: Vec<Fitted>, [gap_before, gap_after]: [f64; 2]) -> Step {
    let (channel, unit) = CHANNEL_NAMES[pick.channel];
    Step {
        effect: pick.candidate.effect,
        class: pick.class,
        channel: channel.to_owned(),
        place: pick.place,
        p_value: pick.p_value,
        parameters,
        gap_before,
        gap_after,
        unit: unit.to_owned(),
        explainable_gap_closed: Interval {
            value: 0.0,
            low: 0.0,
            high: 0.0,
        },
        rivals: pick.rivals,
    }
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
