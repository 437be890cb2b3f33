//! The search: fit, look, name, add, look again; at the end, once, the locked-away runs.

use kufe_sled::effects::{Effects, Kind};
use kufe_sled::{Model, Vehicle};

use crate::error::Error;
use crate::evidence::runs::candidates::catalogue::list;
use crate::evidence::runs::fit::gauss_newton::{fit, free_base, residuals};
use crate::evidence::runs::model::chain::{CHANNEL_NAMES, CHANNELS, Chain};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::outcome::{finish, gap};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::lock;
use crate::evidence::runs::recordings::prepare::Data;
use crate::evidence::runs::screen::track_channel::TrackChannel;
use crate::evidence::runs::searcher::{MOST_LOOKS, MOST_STEPS, Pick, Searcher, Stand, gap_of};
use crate::finding::report::{Fitted, Interval, Report, Step};
use crate::options::Options;

/// What a search found, with the model that carries it.
pub struct Found {
    /// The report.
    pub report: Report,
    /// The model with the effects switched on and everything refitted.
    pub next: Model,
}

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

impl Searcher<'_> {
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
