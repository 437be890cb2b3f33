//! From a recorded run to states: filter, down-sample, transfer, differentiate.

use rayon::prelude::*;

use crate::Error;
use crate::check::LEAST_SAMPLES;
use crate::derivative::derivative;
use crate::filter::{low_pass, noise_gain, resample, resampled_length};
use crate::friction::Vehicle;
use crate::model::Noise;
use crate::noise::{estimate_noise, slip_noise};
use crate::one_track::{AxleForces, Motion, State, inverse, normal_forces};
use crate::run::{Entry, Run};
use crate::transfer::{slips, to_centre_of_gravity};
use kufe_effect::{Conditions, Sensor, Signals};

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
/// [`Error::MissingColumn`], [`Error::TooShort`] where too little is left at the lower rate.
pub fn prepare(
    run: &Run,
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    options: &PrepareOptions,
) -> Result<Prepared, Error> {
    let sled = &vehicle.sled;
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
    if !vehicle.effects.is_empty() {
        take_out(run, vehicle, dt, &mut recorded);
    }
    let [ax, ay, az, roll, pitch, yaw, v, alpha, delta, gamma] =
        Sensor::ALL.map(|sensor| &recorded[sensor as usize]);
    let (roll_accel, pitch_accel, yaw_accel) = (
        derivative(roll, dt),
        derivative(pitch, dt),
        derivative(yaw, dt),
    );
    let distance = match run.columns.get("s_m") {
        Some(s) if s.iter().all(|s| s.is_finite()) => resample(s, from, rate),
        _ => integrate(v, dt),
    };

    let density = run.entry.conditions.air_density();
    let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
    let mut states = Vec::with_capacity(v.len());
    let mut motions = Vec::with_capacity(v.len());
    for i in 0..v.len() {
        let accel = to_centre_of_gravity(
            [ax[i], ay[i], az[i]],
            [roll[i], pitch[i], yaw[i]],
            [roll_accel[i], pitch_accel[i], yaw_accel[i]],
            place,
        );
        let slip = slips(sled, alpha[i], yaw[i], v[i], delta[i]);
        let (fz_f0, fz_r) = normal_forces(sled, accel[2], pitch_accel[i]);
        states.push(State {
            t_s: run.t0_s + i as f64 * dt,
            s_m: distance[i],
            v_mps: v[i],
            alpha_cog_rad: slip.cog,
            alpha_f_rad: slip.front,
            alpha_r_rad: slip.rear,
            delta_rad: delta[i],
            gamma_rad: gamma[i],
            roll_rate_radps: roll[i],
            pitch_rate_radps: pitch[i],
            yaw_rate_radps: yaw[i],
            roll_accel_radps2: roll_accel[i],
            curvature_1pm: -pitch[i] / v[i],
            fz_f0_n: fz_f0,
            fz_r_n: fz_r,
            air_density_kgpm3: density,
            ice_c: run.entry.conditions.ice_c,
            air_c: run.entry.conditions.air_c,
            air_pa: run.entry.conditions.air_pa,
            slip_rate_radps: [0.0; 2],
            accel_mps2: accel,
        });
        motions.push(Motion {
            accel_mps2: accel,
            pitch_accel_radps2: pitch_accel[i],
            yaw_accel_radps2: yaw_accel[i],
        });
    }

    let slip_of = |pick: fn(&State) -> f64| -> Vec<f64> {
        derivative(&states.iter().map(pick).collect::<Vec<_>>(), dt)
    };
    let (front_rate, rear_rate) = (slip_of(|s| s.alpha_f_rad), slip_of(|s| s.alpha_r_rad));
    for (i, state) in states.iter_mut().enumerate() {
        state.slip_rate_radps = [front_rate[i], rear_rate[i]];
    }

    let noise = match noise {
        Some(noise) => *noise,
        None => estimate_noise(run)?,
    };
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

/// Takes the faults of the sensors out of the recorded channels, `dt` [s] between samples.
fn take_out(run: &Run, vehicle: &Vehicle, dt: f64, recorded: &mut [Vec<f64>]) {
    let rates: Vec<Vec<f64>> = recorded.iter().map(|x| derivative(x, dt)).collect();
    let weather = run.entry.conditions;
    let distance = integrate(&recorded[Sensor::Speed as usize], dt);
    for i in 0..distance.len() {
        let mut signals = Signals::default();
        for sensor in Sensor::ALL {
            let k = sensor as usize;
            signals.set(sensor, recorded[k][i], rates[k][i]);
        }
        let at = Conditions {
            t: run.t0_s + i as f64 * dt,
            s: distance[i],
            v: signals[Sensor::Speed],
            ice_c: weather.ice_c,
            air_c: weather.air_c,
            air_pa: weather.air_pa,
            ..Conditions::default()
        };
        vehicle.effects.correct(&at, &mut signals);
        for (channel, value) in recorded.iter_mut().zip(signals.value) {
            channel[i] = value;
        }
    }
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
