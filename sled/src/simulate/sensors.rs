//! Recording of the sensors of a simulated sled.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::column::Sensor;
use crate::conditions::Conditions;
use crate::effects::{Signals, ahead};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::model::vehicle::Vehicle;
use crate::motion::state::lever_acceleration;
use crate::record::gaps::Gaps;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::series::{HALF_WIDTH, derivative};
use crate::simulate::drive::Simulated;
use crate::simulate::dynamics::Instant;
use crate::sled::{Noise, Sled};
use crate::track::table::Track;

/// The recording of a simulated run by the sensors of the sled, in the format of a measured run.
///
/// The accelerometer at r from the centre of gravity measures `f + dw/dt x r + w x (w x r)`, f
/// being the specific force at the centre of gravity; the slip sensor measures speed and slip angle
/// at its own place. The vehicle's faults of sensors are applied. White noise of the stated
/// standard deviations is added to each channel with `seed`; none if `noise` is `None`. `s_m` is
/// the true distance along the track.
pub fn record(
    simulated: &Simulated,
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    entry: Entry,
    seed: u64,
) -> Run {
    let vehicle = vehicle.on_run(&entry.track, &entry.conditions);
    let sled = &vehicle.sled;
    let instants = simulated.instants.iter();
    let mut read: Vec<Signals> = instants
        .map(|instant| true_signals(sled, instant))
        .collect();
    let delays = vehicle.effects.delays();
    if !vehicle.effects.is_empty() {
        let effects = vehicle.effects.clone().in_time();
        if read.len() > 2 * HALF_WIDTH {
            complete_rates(&mut read, simulated.dt_s);
        }
        for (signals, instant) in read.iter_mut().zip(&simulated.instants) {
            effects.disturb(&instant.state.operating_point(), signals);
        }
    }
    let noise = noise.copied().unwrap_or_default();
    let deviation = |sensor: Sensor| match sensor {
        Sensor::Ax | Sensor::Ay | Sensor::Az => noise.accel_mps2,
        Sensor::RollRate | Sensor::PitchRate | Sensor::YawRate => noise.rate_radps,
        Sensor::Speed => noise.speed_mps,
        Sensor::Slip => noise.slip_rad,
        Sensor::Steering => noise.steer_rad,
        Sensor::RollSplit => noise.roll_split_rad,
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x5e50_25ed);
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for sensor in Sensor::ALL {
        let mut values: Vec<f64> = read.iter().map(|signals| signals[sensor]).collect();
        let delay = delays[sensor as usize];
        if delay != 0.0 {
            values = ahead(&values, -delay / simulated.dt_s);
        }
        let sd = deviation(sensor);
        if sd > 0.0 {
            for value in &mut values {
                let normal: f64 = StandardNormal.sample(&mut random);
                *value += sd * normal;
            }
        }
        columns.insert(sensor.name().to_string(), values);
    }
    let distance = simulated.instants.iter().map(|i| i.state.s_m);
    columns.insert("s_m".to_string(), distance.collect());
    Run {
        entry,
        t0_s: 0.0,
        dt_s: simulated.dt_s,
        columns,
        gaps: Gaps::none(simulated.instants.len()),
        saturated: BTreeMap::new(),
        remarks: Vec::new(),
    }
}

/// Readings of ideal sensors of this sled, with the rates that follow from the motion.
fn true_signals(sled: &Sled, instant: &Instant) -> Signals {
    let s = &instant.state;
    let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
    let rates = [s.roll_rate_radps, s.pitch_rate_radps, s.yaw_rate_radps];
    let angular = instant.angular_accel_radps2;
    let lever = lever_acceleration(rates, angular, place);
    let mut signals = Signals {
        sled: *sled,
        ..Signals::default()
    };
    for i in 0..3 {
        signals[Sensor::ACCELEROMETER[i]] = instant.motion.accel_mps2[i] + lever[i];
        signals.set(Sensor::GYROSCOPE[i], rates[i], angular[i]);
    }
    signals.set(Sensor::Speed, s.v_mps, instant.speed_growth);
    let slip_rate = instant.alpha_sensor_rate_radps;
    signals.set(Sensor::Slip, instant.alpha_sensor_rad, slip_rate);
    signals.set(Sensor::Steering, s.delta_rad, instant.steering_rate_radps);
    signals[Sensor::RollSplit] = s.gamma_rad;
    signals
}

/// Sets the rates that do not follow from the motion (accelerations, roll split), by differences of
/// samples.
fn complete_rates(signals: &mut [Signals], dt_s: f64) {
    for sensor in [Sensor::Ax, Sensor::Ay, Sensor::Az, Sensor::RollSplit] {
        let values: Vec<f64> = signals.iter().map(|s| s[sensor]).collect();
        for (signals, rate) in signals.iter_mut().zip(derivative(&values, dt_s)) {
            signals.rate[sensor as usize] = rate;
        }
    }
}

/// An index row for a simulated run.
pub fn simulated_entry(run: &str, track: &Track, driver: &str, conditions: Conditions) -> Entry {
    Entry {
        run: run.to_string(),
        file: PathBuf::from(format!("{run}.csv")),
        track: track.name.clone(),
        driver: driver.to_string(),
        driver_class: "simulated".to_string(),
        session: "1".to_string(),
        conditions,
        ..Entry::default()
    }
}
