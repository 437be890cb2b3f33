//! From a recorded run to states: filter, down-sample, transfer, differentiate.

use kufe_effect::{Sensor, Signals, ahead};
use rayon::prelude::*;

use crate::error::Error;
use crate::model::sled::Noise;
use crate::model::vehicle::Vehicle;
use crate::motion::measured::from_sensors;
use crate::motion::one_track::inverse;
use crate::motion::state::{AxleForces, Motion, State};
use crate::record::check::LEAST_SAMPLES;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::signals::derivative::derivative;
use crate::signals::filter::{low_pass, noise_gain, resample, resampled_length};
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
    /// Standard deviations of the filtered slip angles, front and rear [rad].
    pub slip_sd_rad: [f64; 2],
}

impl Prepared {
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
/// recording where it has one, else integrated from the speed. Effects of the vehicle that stand between the truth and
/// its sensors are taken out. `noise` states the sensors' noise; where absent it is
/// estimated from the recording.
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
    let from = run.rate_hz();
    let lower = options.rate_hz < from * (1.0 - 1e-3);
    let rate = if lower { options.rate_hz } else { from };
    let left = resampled_length(run.len(), from, rate);
    if left < LEAST_SAMPLES {
        return Err(Error::TooShort {
            file: run.entry.file.display().to_string(),
            samples: left,
            needed: LEAST_SAMPLES,
        });
    }
    let channel = |name: &str| -> Result<Vec<f64>, Error> {
        let slow = resample(run.column(name)?, from, rate);
        Ok(low_pass(&slow, rate, options.cutoff_hz))
    };
    let dt = 1.0 / rate;
    let mut recorded = Vec::with_capacity(Sensor::ALL.len());
    for sensor in Sensor::ALL {
        recorded.push(channel(sensor.name())?);
    }
    let samples = recorded[0].len();
    let distance = match run.columns.get("s_m") {
        Some(s) if s.iter().all(|s| s.is_finite()) => resample(s, from, rate),
        _ => integrate(&recorded[Sensor::Speed as usize], dt),
    };
    let further = Further::of(run, vehicle, &effects, |x| resample(x, from, rate))?;
    let conditions =
        |i: usize, v: f64| further.conditions(run, i, run.t0_s + i as f64 * dt, distance[i], v);
    for (channel, delay) in recorded.iter_mut().zip(effects.delays()) {
        if delay != 0.0 {
            *channel = ahead(channel, delay / dt);
        }
    }
    let effects = effects.in_time();
    if !effects.is_empty() {
        let rates: Vec<Vec<f64>> = recorded.iter().map(|x| derivative(x, dt)).collect();
        for i in 0..samples {
            let mut signals = at(&recorded, &rates, i);
            effects.correct(&conditions(i, signals[Sensor::Speed]), &mut signals);
            for (channel, value) in recorded.iter_mut().zip(signals.value) {
                channel[i] = value;
            }
        }
    }
    let rates: Vec<Vec<f64>> = recorded.iter().map(|x| derivative(x, dt)).collect();
    let (states, motions) = (0..samples)
        .map(|i| {
            let signals = at(&recorded, &rates, i);
            from_sensors(sled, &signals, &conditions(i, signals[Sensor::Speed]))
        })
        .unzip();

    let noise = match noise {
        Some(noise) => *noise,
        None => estimate_noise(run)?,
    };
    let v = &recorded[Sensor::Speed as usize];
    let mean_speed = v.iter().sum::<f64>() / v.len() as f64;
    let (front, rear) = slip_noise(sled, &noise, mean_speed);
    // Both filters act on the noise at the recording's own rate; the narrower one decides.
    let gain = noise_gain(
        from,
        options
            .cutoff_hz
            .min(if lower { 0.4 * rate } else { f64::INFINITY }),
    );
    Ok(Prepared {
        entry: run.entry.clone(),
        dt_s: dt,
        states,
        motions,
        slip_sd_rad: [gain * front, gain * rear],
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
