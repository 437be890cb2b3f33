//! From a recorded run to states: filter, down-sample, transfer, differentiate.

use std::ops::Range;

use kufe_effect::{Effects, Sensor, Signals, ahead};
use rayon::prelude::*;

use crate::error::Error;
use crate::model::sled::{Noise, Sled};
use crate::model::vehicle::Vehicle;
use crate::motion::measured::from_sensors;
use crate::motion::one_track::inverse;
use crate::motion::state::{AxleForces, Motion, State};
use crate::record::check::LEAST_SAMPLES;
use crate::record::check::gaps::bridged;
use crate::record::check::taking_part::TakingPart;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::signals::derivative::{HALF_WIDTH, derivative};
use crate::signals::filter::{self, low_pass, noise_gain, ratio, resample_from};
use crate::signals::further::Further;
use crate::signals::noise::{estimate_noise, slip_noise};

/// How a run is brought to the rate that everything else works at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrepareOptions {
    /// Rate after down-sampling [Hz]; a slower recording stays as it is.
    pub rate_hz: f64,
    /// Corner of the zero-phase low pass after that [Hz].
    pub cutoff_hz: f64,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        PrepareOptions {
            rate_hz: 100.0,
            cutoff_hz: 20.0,
        }
    }
}

/// A run as a series of states with the motion measured at each.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Its row in the index.
    pub entry: Entry,
    /// Time between states [s].
    pub dt_s: f64,
    /// States, normal forces included.
    pub states: Vec<State>,
    /// Measured motion at the centre of gravity, beside `states`.
    pub motions: Vec<Motion>,
    /// Stretches of `states` without a gap: within one they are `dt_s` apart, together they are all states.
    pub pieces: Vec<Range<usize>>,
    /// What of the run takes part.
    pub taking_part: TakingPart,
    /// Standard deviations of the filtered slip angles, front and rear [rad].
    pub slip_sd_rad: [f64; 2],
}

impl Prepared {
    /// The time that takes part, a step a state [s].
    pub fn used_s(&self) -> f64 {
        self.states.len() as f64 * self.dt_s
    }

    /// The time from the first state to the last, gaps included [s].
    pub fn span_s(&self) -> f64 {
        match self.states.as_slice() {
            [first, .., last] if self.pieces.len() > 1 => last.t_s - first.t_s + self.dt_s,
            _ => self.used_s(),
        }
    }

    /// Forces on the runners as the motion demands them, one a state.
    pub fn measured_forces(&self, vehicle: &Vehicle) -> Vec<AxleForces> {
        self.states
            .iter()
            .zip(&self.motions)
            .map(|(state, motion)| inverse(vehicle, state, motion))
            .collect()
    }
}

/// Prepares one run.
///
/// In this order: low pass and down-sampling to `rate_hz`, low pass at `cutoff_hz`, angular accelerations by
/// [`derivative`], accelerations to the centre of gravity, slips at the axles, normal forces. `s_m` is taken from the
/// recording where it has one, else integrated from the speed, across a gap of the speed as if it changed evenly there.
/// Effects of the vehicle that stand between the truth and its sensors are taken out. `noise` states the sensors' noise;
/// where absent it is estimated from the recording.
///
/// Every stretch without a gap is filtered by itself. Beside a gap two periods of the corner and the derivative's three
/// samples take no part: the slowest pole of the filter, `sin(pi/8) 2 pi f`, has decayed to 1 % there.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::TooShort`] where too little is left at the lower rate, [`Error::Keys`] for an effect
/// that needs what neither the run's file nor `runs.csv` nor the model states.
pub fn prepare(
    run: &Run,
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    options: &PrepareOptions,
) -> Result<Prepared, Error> {
    let sled = &vehicle.sled;
    let effects = vehicle.effects.on_track(&run.entry.track);
    let base = Resampling::of(run, options);
    let further = Further::of(run, vehicle, &effects)?;
    let (mut states, mut motions, mut pieces) = (Vec::new(), Vec::new(), Vec::new());
    let mut speeds: (f64, usize) = (0.0, 0);
    let mut distance = Distance::of(run)?;
    for (number, piece) in run.gaps.pieces.iter().enumerate() {
        let count = base.samples(piece).len();
        if count < filter::LEAST_SAMPLES {
            continue;
        }
        let all = prepare_piece(run, piece, &base, sled, &effects, &further, &mut distance)?;
        speeds.0 += all.iter().map(|(state, _)| state.v_mps).sum::<f64>();
        speeds.1 += count;
        let last = run.gaps.pieces.len() - 1;
        let from = if number == 0 { 0 } else { base.margin };
        let to = count.saturating_sub(if number == last { 0 } else { base.margin });
        if from < to {
            let start = states.len();
            for (state, motion) in &all[from..to] {
                states.push(*state);
                motions.push(*motion);
            }
            pieces.push(start..states.len());
        }
    }
    if states.len() < LEAST_SAMPLES {
        return Err(Error::TooShort {
            file: run.entry.file.display().to_string(),
            samples: states.len(),
            needed: LEAST_SAMPLES,
        });
    }
    let noise = match noise {
        Some(noise) => *noise,
        None => estimate_noise(run)?,
    };
    let mean_speed = speeds.0 / speeds.1 as f64;
    let (front, rear) = slip_noise(sled, &noise, mean_speed);
    // Both filters act on the noise at the recording's own rate; the narrower one decides.
    let gain = noise_gain(base.from_hz, base.narrowest_hz);
    let mut prepared = Prepared {
        entry: run.entry.clone(),
        dt_s: 1.0 / base.rate_hz,
        taking_part: TakingPart {
            run: run.entry.run.clone(),
            gaps: run.gaps.clone(),
            stretches: pieces.len(),
            used_s: 0.0,
            of_s: 0.0,
        },
        states,
        motions,
        pieces,
        slip_sd_rad: [gain * front, gain * rear],
    };
    let (used_s, of_s) = (prepared.used_s(), run.len() as f64 * run.dt_s);
    (prepared.taking_part.used_s, prepared.taking_part.of_s) = (used_s, of_s);
    Ok(prepared)
}

/// The even times at the lower rate, and what stands beside a gap.
struct Resampling {
    from_hz: f64,
    rate_hz: f64,
    /// Samples of the recording a state.
    ratio: f64,
    cutoff_hz: f64,
    /// Corner of the narrower of both low passes [Hz].
    narrowest_hz: f64,
    /// States beside a gap that take no part.
    margin: usize,
}

impl Resampling {
    fn of(run: &Run, options: &PrepareOptions) -> Resampling {
        let from = run.rate_hz();
        let lower = options.rate_hz < from * (1.0 - 1e-3);
        let rate = if lower { options.rate_hz } else { from };
        let narrowest_hz = options
            .cutoff_hz
            .min(if lower { 0.4 * rate } else { f64::INFINITY });
        let periods = if narrowest_hz < 0.5 * from {
            (2.0 * rate / narrowest_hz).ceil() as usize
        } else {
            0
        };
        Resampling {
            from_hz: from,
            rate_hz: rate,
            ratio: if lower { ratio(from, rate) } else { 1.0 },
            cutoff_hz: options.cutoff_hz,
            narrowest_hz,
            margin: periods + HALF_WIDTH,
        }
    }

    /// The states, counted from the first sample of the run, that lie in a stretch of the recording.
    fn samples(&self, piece: &Range<usize>) -> Range<usize> {
        let first = (piece.start as f64 / self.ratio - 1e-9).ceil() as usize;
        first..((piece.end - 1) as f64 / self.ratio + 1e-9).floor() as usize + 1
    }

    /// A stretch of a column at the rate of the states.
    fn resampled(&self, column: &[f64], piece: &Range<usize>) -> Vec<f64> {
        let first = self.samples(piece).start as f64 * self.ratio;
        let offset = first - piece.start as f64;
        resample_from(&column[piece.clone()], self.from_hz, self.rate_hz, offset)
    }
}

/// Where the sled is: as recorded, or from the speed.
enum Distance {
    Recorded(Vec<f64>),
    FromSpeed {
        /// Speed across gaps of it [m/s].
        bridged: Vec<f64>,
        /// The last state before the next stretch: its place in the recording, distance and speed.
        before: Option<(f64, f64, f64)>,
    },
}

impl Distance {
    fn of(run: &Run) -> Result<Distance, Error> {
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

    /// Distances of a stretch's states, `v` being their speeds.
    fn of_piece(&mut self, base: &Resampling, piece: &Range<usize>, v: &[f64]) -> Vec<f64> {
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
                let mut distance = integrate(v, 1.0 / base.rate_hz);
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

/// Integral of the speed between two states, by the trapezoidal rule over the samples between; in samples times m/s.
fn across(v: &[f64], (from, v_from): (f64, f64), (to, v_to): (f64, f64)) -> f64 {
    let between = from.floor() as usize + 1..to.ceil() as usize;
    let inner = between.map(|i| (i as f64, v[i]));
    let points = std::iter::once((from, v_from))
        .chain(inner)
        .chain([(to, v_to)]);
    let mut sum = 0.0;
    let mut before = (from, v_from);
    for point in points {
        sum += 0.5 * (point.0 - before.0) * (point.1 + before.1);
        before = point;
    }
    sum
}

/// All states of one stretch without a gap, those beside a gap included.
fn prepare_piece(
    run: &Run,
    piece: &Range<usize>,
    base: &Resampling,
    sled: &Sled,
    effects: &Effects,
    further: &Further,
    distance: &mut Distance,
) -> Result<Vec<(State, Motion)>, Error> {
    let rate = base.rate_hz;
    let dt = 1.0 / rate;
    let mut recorded = Vec::with_capacity(Sensor::ALL.len());
    for sensor in Sensor::ALL {
        let slow = base.resampled(run.column(sensor.name())?, piece);
        recorded.push(low_pass(&slow, rate, base.cutoff_hz));
    }
    let samples = base.samples(piece);
    let distance = distance.of_piece(base, piece, &recorded[Sensor::Speed as usize]);
    let further = further.piece(|column| base.resampled(column, piece));
    let first = samples.start;
    let conditions = |i: usize, v: f64| {
        let t = run.t0_s + (first + i) as f64 * dt;
        further.conditions(run, i, t, distance[i], v)
    };
    for (channel, delay) in recorded.iter_mut().zip(effects.delays()) {
        if delay != 0.0 {
            *channel = ahead(channel, delay / dt);
        }
    }
    let effects = effects.clone().in_time();
    if !effects.is_empty() {
        let rates: Vec<Vec<f64>> = recorded.iter().map(|x| derivative(x, dt)).collect();
        for i in 0..samples.len() {
            let mut signals = at(&recorded, &rates, i);
            effects.correct(&conditions(i, signals[Sensor::Speed]), &mut signals);
            for (channel, value) in recorded.iter_mut().zip(signals.value) {
                channel[i] = value;
            }
        }
    }
    let rates: Vec<Vec<f64>> = recorded.iter().map(|x| derivative(x, dt)).collect();
    let states = (0..samples.len()).map(|i| {
        let signals = at(&recorded, &rates, i);
        from_sensors(sled, &signals, &conditions(i, signals[Sensor::Speed]))
    });
    Ok(states.collect())
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

/// Sample `i` of all sensors with its rates.
fn at(recorded: &[Vec<f64>], rates: &[Vec<f64>], i: usize) -> Signals {
    let mut signals = Signals::default();
    for sensor in Sensor::ALL {
        let k = sensor as usize;
        signals.set(sensor, recorded[k][i], rates[k][i]);
    }
    signals
}

/// Distance from speed by the trapezoidal rule.
fn integrate(v: &[f64], dt: f64) -> Vec<f64> {
    let mut s = 0.0;
    let mut distance = vec![0.0; v.len()];
    for i in 1..v.len() {
        s += 0.5 * dt * (v[i - 1] + v[i]);
        distance[i] = s;
    }
    distance
}
