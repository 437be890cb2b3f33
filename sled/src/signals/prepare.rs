//! From a recorded run to states: filtering, down-sampling, transfer to the centre of gravity,
//! differentiation.

use std::ops::Range;

use rayon::prelude::*;

use crate::effects::{Active, Effects, Relaxed};
use crate::error::Error;
use crate::model::vehicle::Vehicle;
use crate::motion::one_track::forward;
use crate::motion::state::{Motion, State, from_sensors};
use crate::record::check::MIN_RUN_SAMPLES;
use crate::record::gaps::SampleCoverage;
use crate::record::index::Entry;
use crate::record::needs::Needs;
use crate::record::run::Run;
use crate::series::{HALF_WIDTH, bridged, integral, noise_gain, ratio, resample_from};
use crate::signals::filtered::{FilteredSignals, estimate_noise, no_number, slip_noise};
use crate::sled::Noise;

/// A run as a series of states, each with the measured motion.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Its row in the index.
    pub entry: Entry,
    /// Time between states [s].
    pub dt_s: f64,
    /// States, normal forces included.
    pub states: Vec<State>,
    /// Measured motion at the centre of gravity, one for each of `states`.
    pub motions: Vec<Motion>,
    /// Stretches of `states` without a gap, which together contain all states. Within a stretch
    /// states are `dt_s` apart.
    pub pieces: Vec<Range<usize>>,
    /// The part of the run that is used.
    pub taking_part: SampleCoverage,
    /// Standard deviations of the filtered slip angles, front and rear [rad].
    pub slip_sd_rad: [f64; 2],
}

impl Prepared {
    /// Duration of the states: their number times `dt_s` [s].
    pub fn used_s(&self) -> f64 {
        self.states.len() as f64 * self.dt_s
    }

    /// Duration from the first state to the last, including gaps [s].
    pub fn span_s(&self) -> f64 {
        match self.states.as_slice() {
            [first, .., last] if self.pieces.len() > 1 => last.t_s - first.t_s + self.dt_s,
            _ => self.used_s(),
        }
    }
}

/// Prepares one run.
///
/// In this order: low pass and down-sampling to `rate_hz`, low pass at `cutoff_hz`, angular
/// accelerations by [`derivative`], accelerations to the centre of gravity, slips at the axles,
/// normal forces. `s_m` is the recorded one, else the integral of the speed, which is interpolated
/// linearly across gaps. The vehicle's faults of sensors are corrected. Columns that
/// `options.needs` does not name and that are not recorded are 0, except `ax_mps2`, which is NaN.
/// `noise` states the sensors' noise; if `None`, it is estimated from the recording.
///
/// Every stretch without a gap is filtered separately. Next to a gap two periods of the cutoff
/// frequency and the derivative's three samples are discarded. After them the slowest pole of the
/// filter, `sin(pi/8) 2 pi f`, has decayed to 1 %.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::TooFew`] if too few samples remain at the lower rate,
/// [`Error::File`] for an effect that needs a quantity which neither the run's file nor `runs.csv`
/// nor the model states.
pub fn prepare(
    run: &Run,
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    options: &PrepareOptions,
) -> Result<Prepared, Error> {
    let vehicle = &vehicle.on_run(&run.entry.track, &run.entry.conditions);
    let (sled, effects) = (&vehicle.sled, &vehicle.effects);
    let base = Resampling::of(run, options);
    let stretches = FilteredSignals::stretches(run, vehicle, effects, &options.needs, &base)?;
    let (mut states, mut motions, mut pieces) = (Vec::new(), Vec::new(), Vec::new());
    let mut speeds: (f64, usize) = (0.0, 0);
    let along = run.columns.contains_key("ax_mps2");
    for (sensed, valid) in stretches {
        let count = sensed.len();
        speeds.0 += (0..count).map(|i| sensed.operating_point(i).v).sum::<f64>();
        speeds.1 += count;
        let start = states.len();
        let mut relaxed = Relaxed::default();
        for i in valid {
            let (mut state, mut motion) =
                from_sensors(sled, &sensed.signals(i), &sensed.operating_point(i));
            if !along {
                // An unmeasured acceleration is NaN, so that no result depends on it.
                (motion.accel_mps2[0], state.accel_mps2[0]) = (f64::NAN, f64::NAN);
            }
            if let Some(distance) = effects.relaxation() {
                state.slip_rate_radps =
                    state.followed_rates(&mut relaxed, 1.0 / base.rate_hz, distance);
            }
            states.push(state);
            motions.push(motion);
        }
        if start < states.len() {
            pieces.push(start..states.len());
        }
    }
    if options.needs.forces {
        refuse_not_finite(run, vehicle, &states)?;
    }
    refuse_short(run, states.len())?;
    let noise = noise.copied().unwrap_or_else(|| estimate_noise(run));
    let mean_speed = speeds.0 / speeds.1 as f64;
    let (front, rear) = slip_noise(sled, &noise, mean_speed);
    // Both filters act on the noise at the rate of the recording; the lower cutoff determines the
    // gain.
    let gain = noise_gain(base.from_hz, base.narrowest_hz);
    let dt_s = 1.0 / base.rate_hz;
    Ok(Prepared {
        entry: run.entry.clone(),
        dt_s,
        taking_part: run.coverage(pieces.len(), states.len() as f64 * dt_s),
        states,
        motions,
        pieces,
        slip_sd_rad: [gain * front, gain * rear],
    })
}

/// Refuses a run with too few samples at the lower rate.
pub(crate) fn refuse_short(run: &Run, samples: usize) -> Result<(), Error> {
    if samples >= MIN_RUN_SAMPLES {
        return Ok(());
    }
    let what = format!("{}: samples", run.entry.file.display());
    Err(Error::too_few(what, samples, MIN_RUN_SAMPLES))
}

/// Refuses effects whose forces are not finite at a state: they would silently disable comparisons
/// with the model.
fn refuse_not_finite(run: &Run, vehicle: &Vehicle, states: &[State]) -> Result<(), Error> {
    if vehicle.effects.is_empty() {
        return Ok(());
    }
    let bad = |vehicle: &Vehicle, state: &State| {
        let forces = forward(vehicle, state);
        let all = forces.front.iter().chain(&forces.rear).chain(&forces.body);
        all.copied().any(|force| !force.is_finite())
    };
    let Some(state) = states.iter().find(|state| bad(vehicle, state)) else {
        return Ok(());
    };
    let alone = |effect: &&Active| {
        let one = Vehicle {
            effects: Effects {
                active: vec![(*effect).clone()],
            },
            ..vehicle.clone()
        };
        bad(&one, state)
    };
    let effect = vehicle.effects.active.iter().find(alone);
    effect.map_or(Ok(()), |effect| {
        Err(no_number(run, Some(effect), state.t_s, state.s_m))
    })
}

/// Prepares every run, in parallel and in order.
///
/// # Errors
/// The first run's error in order.
pub fn prepare_all(
    runs: &[Run],
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    options: &PrepareOptions,
) -> Result<Vec<Prepared>, Error> {
    runs.par_iter()
        .map(|run| prepare(run, vehicle, noise, options))
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

/// Options of [`prepare`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrepareOptions {
    /// Rate after down-sampling [Hz]; a slower recording keeps its rate.
    pub rate_hz: f64,
    /// Cutoff frequency of the zero-phase low pass after down-sampling [Hz].
    pub cutoff_hz: f64,
    /// Required columns.
    pub needs: Needs,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        PrepareOptions {
            rate_hz: 100.0,
            cutoff_hz: 20.0,
            needs: Needs::FORCES,
        }
    }
}

/// Uniform sampling at the lower rate, and the margin next to a gap.
pub(crate) struct Resampling {
    /// Rate of the recording [Hz].
    pub(crate) from_hz: f64,
    /// Rate of the states [Hz].
    pub(crate) rate_hz: f64,
    /// Samples of the recording per state.
    pub(crate) ratio: f64,
    /// Cutoff frequency of the low pass at the rate of the states [Hz].
    pub(crate) cutoff_hz: f64,
    /// Lower cutoff frequency of both low passes [Hz].
    pub(crate) narrowest_hz: f64,
    /// Number of states next to a gap that are discarded.
    pub(crate) margin: usize,
}

impl Resampling {
    pub(crate) fn of(run: &Run, options: &PrepareOptions) -> Resampling {
        let from = run.rate_hz();
        let lower = options.rate_hz < from * (1.0 - 1e-3);
        let rate = if lower { options.rate_hz } else { from };
        let of_resampling = if lower { 0.4 * rate } else { f64::INFINITY };
        let narrowest_hz = options.cutoff_hz.min(of_resampling);
        let filtered = narrowest_hz < 0.5 * from;
        let periods = if filtered {
            2.0 * rate / narrowest_hz
        } else {
            0.0
        };
        Resampling {
            from_hz: from,
            rate_hz: rate,
            ratio: if lower { ratio(from, rate) } else { 1.0 },
            cutoff_hz: options.cutoff_hz,
            narrowest_hz,
            margin: periods.ceil() as usize + HALF_WIDTH,
        }
    }

    /// The states, counted from the first sample of the run, that lie in a stretch of the
    /// recording.
    pub(crate) fn samples(&self, piece: &Range<usize>) -> Range<usize> {
        let first = (piece.start as f64 / self.ratio - 1e-9).ceil() as usize;
        first..((piece.end - 1) as f64 / self.ratio + 1e-9).floor() as usize + 1
    }

    /// A stretch of a column at the rate of the states.
    pub(crate) fn resampled(&self, column: &[f64], piece: &Range<usize>) -> Vec<f64> {
        let first = self.samples(piece).start as f64 * self.ratio;
        let offset = first - piece.start as f64;
        resample_from(&column[piece.clone()], self.from_hz, self.rate_hz, offset)
    }

    /// The states of stretch `number` of `stretches` that are used, of `count` in all: without the
    /// margins next to gaps.
    pub(crate) fn valid_range(
        &self,
        number: usize,
        stretches: usize,
        count: usize,
    ) -> Range<usize> {
        let from = if number == 0 { 0 } else { self.margin };
        let last = number + 1 == stretches;
        let after = if last { 0 } else { self.margin };
        from..count.saturating_sub(after).max(from)
    }
}

/// Source of the distance: the recording, or the integral of the speed.
pub(crate) enum Distance {
    Recorded(Vec<f64>),
    FromSpeed {
        /// Speed with its gaps interpolated [m/s].
        bridged: Vec<f64>,
        /// The last state before the next stretch: its sample number in the recording, distance and
        /// speed.
        before: Option<(f64, f64, f64)>,
    },
}

impl Distance {
    pub(crate) fn of(run: &Run) -> Result<Distance, Error> {
        Ok(match run.columns.get("s_m") {
            Some(s) if run.gaps.within(s).flatten().all(|s| s.is_finite()) => {
                Distance::Recorded(s.clone())
            }
            _ => Distance::FromSpeed {
                bridged: bridged(run.column("v_mps")?),
                before: None,
            },
        })
    }

    /// Distances [m] of the states of a stretch with the speeds `v`.
    pub(crate) fn of_piece(
        &mut self,
        base: &Resampling,
        piece: &Range<usize>,
        v: &[f64],
    ) -> Vec<f64> {
        match self {
            Distance::Recorded(s) => base.resampled(s, piece),
            Distance::FromSpeed { bridged, before } => {
                let first = base.samples(piece).start as f64 * base.ratio;
                let start = match *before {
                    None => 0.0,
                    Some((from, s, v_from)) => {
                        s + across(bridged, (from, v_from), (first, v[0])) / base.from_hz
                    }
                };
                let mut distance = integral(v, 1.0 / base.rate_hz);
                if start != 0.0 {
                    distance.iter_mut().for_each(|s| *s += start);
                }
                let last = v.len() - 1;
                *before = Some((first + last as f64 * base.ratio, distance[last], v[last]));
                distance
            }
        }
    }
}

/// Integral of the speed between two states by the trapezoidal rule over the samples between, in
/// samples times m/s.
fn across(v: &[f64], (from, v_from): (f64, f64), (to, v_to): (f64, f64)) -> f64 {
    let between = from.floor() as usize + 1..to.ceil() as usize;
    let points = between.map(|i| (i as f64, v[i])).chain([(to, v_to)]);
    let mut sum = 0.0;
    let mut before = (from, v_from);
    for point in points {
        sum += 0.5 * (point.0 - before.0) * (point.1 + before.1);
        before = point;
    }
    sum
}
