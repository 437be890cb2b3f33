//! What the sensors of a simulated sled record.

use std::collections::BTreeMap;
use std::path::PathBuf;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::effects::Measured;
use crate::model::sled::Noise;
use crate::model::vehicle::Vehicle;
use crate::motion::transfer::lever_acceleration;
use crate::record::index::{Conditions, Entry};
use crate::record::run::Run;
use crate::simulate::drive::Simulated;
use crate::simulate::dynamics::Instant;
use crate::track::table::Track;

/// What the sensors of the sled record of a simulated run, in the format of a measured one.
///
/// The accelerometer at its place feels `f + dw/dt x r + w x (w x r)`, f being the specific force at the centre of
/// gravity; the slip sensor sees speed and slip angle at its own place. Effects of the vehicle that stand between the
/// truth and its sensors act. White noise of the stated deviations is added to each channel with `seed`; none where
/// `noise` is absent. `s_m` is the true distance along the track.
pub fn record(
    simulated: &Simulated,
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    entry: Entry,
    seed: u64,
) -> Run {
    let vehicle = vehicle.on_track(&entry.track);
    let sled = &vehicle.sled;
    let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
    let felt: Vec<Measured> = simulated
        .instants
        .iter()
        .map(|instant| {
            let s = &instant.state;
            let rates = [s.roll_rate_radps, s.pitch_rate_radps, s.yaw_rate_radps];
            let lever = lever_acceleration(rates, instant.angular_accel_radps2, place);
            let mut measured = Measured {
                acceleration: std::array::from_fn(|i| instant.motion.accel_mps2[i] + lever[i]),
                slip: instant.alpha_sensor_rad,
                slip_rate: instant.alpha_sensor_rate_radps,
                steering: s.delta_rad,
                accelerometer: place,
                mass: sled.mass_kg,
            };
            vehicle.effects.disturb(&mut measured);
            measured
        })
        .collect();
    let of = |value: &dyn Fn(&Instant) -> f64| simulated.instants.iter().map(value).collect();
    let silent = Noise::default();
    let noise = noise.unwrap_or(&silent);
    let mut channels: Vec<(&str, Vec<f64>, f64)> = vec![
        (
            "ax_mps2",
            felt.iter().map(|f| f.acceleration[0]).collect(),
            noise.accel_mps2,
        ),
        (
            "ay_mps2",
            felt.iter().map(|f| f.acceleration[1]).collect(),
            noise.accel_mps2,
        ),
        (
            "az_mps2",
            felt.iter().map(|f| f.acceleration[2]).collect(),
            noise.accel_mps2,
        ),
        (
            "roll_rate_radps",
            of(&|i| i.state.roll_rate_radps),
            noise.rate_radps,
        ),
        (
            "pitch_rate_radps",
            of(&|i| i.state.pitch_rate_radps),
            noise.rate_radps,
        ),
        (
            "yaw_rate_radps",
            of(&|i| i.state.yaw_rate_radps),
            noise.rate_radps,
        ),
        ("v_mps", of(&|i| i.state.v_mps), noise.speed_mps),
        (
            "alpha_rad",
            felt.iter().map(|f| f.slip).collect(),
            noise.slip_rad,
        ),
        (
            "delta_rad",
            felt.iter().map(|f| f.steering).collect(),
            noise.steer_rad,
        ),
        (
            "gamma_rad",
            of(&|i| i.state.gamma_rad),
            noise.roll_split_rad,
        ),
        ("s_m", of(&|i| i.state.s_m), 0.0),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x5e50_25ed);
    for (_, values, sd) in &mut channels {
        if *sd > 0.0 {
            for value in values.iter_mut() {
                let normal: f64 = StandardNormal.sample(&mut random);
                *value += *sd * normal;
            }
        }
    }
    let columns: BTreeMap<String, Vec<f64>> = channels
        .into_iter()
        .map(|(name, values, _)| (name.to_string(), values))
        .collect();
    Run {
        entry,
        t0_s: 0.0,
        dt_s: simulated.dt_s,
        columns,
        remarks: Vec::new(),
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
    }
}
