//! From a recorded run to states: filter, down-sample, transfer, differentiate.

use rayon::prelude::*;

use crate::effects::Measured;
use crate::error::Error;
use crate::model::sled::Noise;
use crate::model::vehicle::Vehicle;
use crate::motion::one_track::{AxleForces, Motion, State, inverse, normal_forces};
use crate::motion::transfer::{slips, to_centre_of_gravity};
use crate::record::check::LEAST_SAMPLES;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::signals::derivative::derivative;
use crate::signals::filter::{low_pass, noise_gain, resample, resampled_length};
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
    let (ax, ay, az) = (
        channel("ax_mps2")?,
        channel("ay_mps2")?,
        channel("az_mps2")?,
    );
    let (roll, pitch, yaw) = (
        channel("roll_rate_radps")?,
        channel("pitch_rate_radps")?,
        channel("yaw_rate_radps")?,
    );
    let (v, mut alpha) = (channel("v_mps")?, channel("alpha_rad")?);
    let (mut delta, gamma) = (channel("delta_rad")?, channel("gamma_rad")?);
    let dt = 1.0 / rate;
    let (mut ax, mut ay, mut az) = (ax, ay, az);
    if !vehicle.effects.is_empty() {
        let slip_rate = derivative(&alpha, dt);
        for i in 0..v.len() {
            let mut measured = Measured {
                acceleration: [ax[i], ay[i], az[i]],
                slip: alpha[i],
                slip_rate: slip_rate[i],
                steering: delta[i],
                ..Measured::default()
            };
            vehicle.effects.correct(&mut measured);
            [ax[i], ay[i], az[i]] = measured.acceleration;
            (alpha[i], delta[i]) = (measured.slip, measured.steering);
        }
    }
    let (roll_accel, pitch_accel, yaw_accel) = (
        derivative(&roll, dt),
        derivative(&pitch, dt),
        derivative(&yaw, dt),
    );
    let distance = match run.columns.get("s_m") {
        Some(s) if s.iter().all(|s| s.is_finite()) => resample(s, from, rate),
        _ => integrate(&v, dt),
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
