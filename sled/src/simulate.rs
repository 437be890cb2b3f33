//! Driving a track: fixed steps of fourth order, in the format of a measured run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::Error;
use crate::derivative::{HALF_WIDTH, derivative};
use crate::driver::Driver;
use crate::dynamics::{Before, COUNT, Instant, Unknowns, WallContact, World};
use crate::friction::Vehicle;
use crate::model::{Noise, Sled};
use crate::one_track::State;
use crate::run::{Conditions, Entry, Run};
use crate::track::{Track, TrackShape};
use crate::transfer::lever_acceleration;
use kufe_effect::{Conditions as Seen, Sensor, Signals};

/// How to drive.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulateOptions {
    /// Largest step [s]; the step taken divides the output interval.
    pub step_s: f64,
    /// Output rate [Hz].
    pub rate_hz: f64,
    /// Speed at the start [m/s].
    pub start_speed_mps: f64,
    /// Longest time simulated [s].
    pub most_s: f64,
    /// Ice and air.
    pub conditions: Conditions,
    /// Pushes from outside.
    pub contacts: Vec<WallContact>,
    /// Curvature of the channel's cross-section [1/m].
    pub cross_curvature_1pm: f64,
    /// Seed of the driver's noise and, apart from it, of the sensors'.
    pub seed: u64,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        SimulateOptions {
            step_s: 1e-3,
            rate_hz: 500.0,
            start_speed_mps: 10.0,
            most_s: 600.0,
            conditions: Conditions {
                ice_c: -8.0,
                air_c: 0.0,
                air_pa: 95_000.0,
            },
            contacts: Vec::new(),
            cross_curvature_1pm: 0.25,
            seed: 1,
        }
    }
}

/// Work and energy over a simulation [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// Kinetic energy at the start.
    pub kinetic_start_j: f64,
    /// Kinetic energy at the end.
    pub kinetic_end_j: f64,
    /// Work of gravity.
    pub gravity_j: f64,
    /// Work of the ice, negative.
    pub ice_j: f64,
    /// Work of the air, negative.
    pub air_j: f64,
    /// Work of wall contacts.
    pub wall_j: f64,
}

impl EnergyBalance {
    /// What does not add up, relative to the largest term.
    pub fn relative_error(&self) -> f64 {
        let work = self.gravity_j + self.ice_j + self.air_j + self.wall_j;
        let scale = self
            .kinetic_end_j
            .max(self.kinetic_start_j)
            .max(self.gravity_j.abs());
        (self.kinetic_end_j - self.kinetic_start_j - work).abs() / scale
    }
}

/// A simulated run without its sensors.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// One instant an output sample.
    pub instants: Vec<Instant>,
    /// Left of the ideal line at each sample [m].
    pub offset_m: Vec<f64>,
    /// Time between samples [s].
    pub dt_s: f64,
    /// Whether the finish was reached, and not just the time spent.
    pub finished: bool,
    /// Work and energy.
    pub energy: EnergyBalance,
    /// Steps taken.
    pub steps: usize,
}

/// Drives a sled down a track.
///
/// Fixed steps of fourth order (Adams-Bashforth, started by Runge-Kutta) on the equations of motion in `dynamics.rs`, from
/// the track's start to its finish: one evaluation of the forces a step, as a simulator in real time can afford.
/// Deterministic: the same arguments give the same bits. Steps above about 10 ms are unstable at low speed.
///
/// # Errors
/// [`Error::KeyRange`] for options out of range, [`Error::Stopped`] where the sled comes to rest or leaves the track.
pub fn simulate(
    vehicle: &Vehicle,
    track: &TrackShape,
    driver: &Driver,
    options: &SimulateOptions,
) -> Result<Simulated, Error> {
    let every = check(options)?;
    let vehicle = &vehicle.on_track(&track.name);
    let dt_s = 1.0 / options.rate_hz;
    let h = dt_s / every as f64;
    let world = World {
        vehicle,
        shape: track,
        conditions: options.conditions,
        density: options.conditions.air_density(),
        driver,
        mood: driver.mood(track.start_m, track.finish_m, options.seed),
        contacts: &options.contacts,
        cross_curvature: options.cross_curvature_1pm,
    };
    let mut y: Unknowns = [0.0; COUNT];
    y[0] = track.start_m;
    y[3] = options.start_speed_mps;
    let kinetic_start_j = world.kinetic_energy(&y);
    let mut before = Before::default();
    // The first instant's growth of speed is not known yet; a few rounds settle it.
    for _ in 0..4 {
        before = World::before(&world.rates(&y, &before).1, &before);
    }
    let mut growth_then = before.growth;
    let expected = ((track.finish_m - track.start_m) / options.start_speed_mps / dt_s) as usize;
    let mut instants = Vec::with_capacity(expected.min(1 << 16));
    let mut offset_m = Vec::with_capacity(expected.min(1 << 16));
    // Rates of the last steps, newest first.
    let mut past = [[0.0; COUNT]; 4];
    let mut steps = 0;
    let most = (options.most_s / h).ceil() as usize;
    let finished = loop {
        let growth_now = before.growth;
        before.growth = 2.0 * growth_now - growth_then;
        growth_then = growth_now;
        let (rates, mut instant) = world.rates(&y, &before);
        before = World::before(&instant, &before);
        past.rotate_right(1);
        past[0] = rates;
        if steps % every == 0 {
            if let Some(what) = world.trouble(&y) {
                return Err(Error::Stopped {
                    s_m: y[0],
                    t_s: steps as f64 * h,
                    what,
                });
            }
            instant.state.t_s = (steps / every) as f64 / options.rate_hz;
            instants.push(instant);
            offset_m.push(y[1]);
        }
        if y[0] >= track.finish_m {
            break true;
        }
        if steps >= most {
            break false;
        }
        y = if steps < 3 {
            runge_kutta(&world, &y, &rates, &before, h)
        } else {
            adams_bashforth(&y, &past, h)
        };
        steps += 1;
    };
    Ok(Simulated {
        instants,
        offset_m,
        dt_s,
        finished,
        energy: EnergyBalance {
            kinetic_start_j,
            kinetic_end_j: world.kinetic_energy(&y),
            gravity_j: y[7],
            ice_j: y[8],
            air_j: y[9],
            wall_j: y[10],
        },
        steps,
    })
}

/// Steps an output interval.
fn check(options: &SimulateOptions) -> Result<usize, Error> {
    let ranges = [
        ("step_s", options.step_s, 1e-6, 0.01),
        ("rate_hz", options.rate_hz, 1.0, 10_000.0),
        ("start_speed_mps", options.start_speed_mps, 1.0, 60.0),
        ("most_s", options.most_s, 0.1, 3600.0),
        ("cross_curvature_1pm", options.cross_curvature_1pm, 0.0, 2.0),
    ];
    for (key, value, low, high) in ranges {
        if !(low..=high).contains(&value) {
            return Err(Error::KeyRange {
                file: "simulation".to_string(),
                key: format!("{key} (from {low} to {high})"),
                value,
                expected: "a number in that range",
            });
        }
    }
    Ok((1.0 / (options.rate_hz * options.step_s) - 1e-9)
        .ceil()
        .max(1.0) as usize)
}

/// Adams and Bashforth's step of fourth order: one evaluation of the forces a step.
///
/// `y + h/24 (55 f_0 - 59 f_-1 + 37 f_-2 - 9 f_-3)`
fn adams_bashforth(y: &Unknowns, past: &[Unknowns; 4], h: f64) -> Unknowns {
    std::array::from_fn(|i| {
        let mean = 55.0 * past[0][i] - 59.0 * past[1][i] + 37.0 * past[2][i] - 9.0 * past[3][i];
        y[i] + h / 24.0 * mean
    })
}

/// The classical Runge-Kutta step of fourth order, which starts the multistep method.
fn runge_kutta(world: &World, y: &Unknowns, k1: &Unknowns, before: &Before, h: f64) -> Unknowns {
    let k2 = world.rates(&ahead(y, k1, 0.5 * h), before).0;
    let k3 = world.rates(&ahead(y, &k2, 0.5 * h), before).0;
    let k4 = world.rates(&ahead(y, &k3, h), before).0;
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

fn ahead(y: &Unknowns, rates: &Unknowns, h: f64) -> Unknowns {
    std::array::from_fn(|i| y[i] + h * rates[i])
}

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
    let mut read: Vec<Signals> = simulated
        .instants
        .iter()
        .map(|instant| true_signals(sled, instant))
        .collect();
    if !vehicle.effects.is_empty() {
        if read.len() > 2 * HALF_WIDTH {
            complete_rates(&mut read, simulated.dt_s);
        }
        for (signals, instant) in read.iter_mut().zip(&simulated.instants) {
            vehicle.effects.disturb(&seen(&instant.state), signals);
        }
    }
    let silent = Noise::default();
    let noise = noise.unwrap_or(&silent);
    let deviation = |sensor: Sensor| match sensor {
        Sensor::Ax | Sensor::Ay | Sensor::Az => noise.accel_mps2,
        Sensor::RollRate | Sensor::PitchRate | Sensor::YawRate => noise.rate_radps,
        Sensor::Speed => noise.speed_mps,
        Sensor::Slip => noise.slip_rad,
        Sensor::Steering => noise.steer_rad,
        Sensor::RollSplit => noise.roll_split_rad,
    };
    let mut channels: Vec<(&str, Vec<f64>, f64)> = Sensor::ALL
        .into_iter()
        .map(|sensor| {
            let values = read.iter().map(|signals| signals[sensor]).collect();
            (sensor.name(), values, deviation(sensor))
        })
        .collect();
    let distance = simulated.instants.iter().map(|i| i.state.s_m).collect();
    channels.push(("s_m", distance, 0.0));
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

/// What faultless sensors of this sled would say, with the rates that the motion tells.
fn true_signals(sled: &Sled, instant: &Instant) -> Signals {
    let s = &instant.state;
    let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
    let rates = [s.roll_rate_radps, s.pitch_rate_radps, s.yaw_rate_radps];
    let angular = instant.angular_accel_radps2;
    let lever = lever_acceleration(rates, angular, place);
    let mut signals = Signals {
        sled: sled.constants(),
        ..Signals::default()
    };
    for (i, sensor) in [Sensor::Ax, Sensor::Ay, Sensor::Az].into_iter().enumerate() {
        signals[sensor] = instant.motion.accel_mps2[i] + lever[i];
    }
    let gyroscopes = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
    for (i, sensor) in gyroscopes.into_iter().enumerate() {
        signals.set(sensor, rates[i], angular[i]);
    }
    signals.set(Sensor::Speed, s.v_mps, instant.speed_growth);
    let slip_rate = instant.alpha_sensor_rate_radps;
    signals.set(Sensor::Slip, instant.alpha_sensor_rad, slip_rate);
    signals.set(Sensor::Steering, s.delta_rad, instant.steering_rate_radps);
    signals[Sensor::RollSplit] = s.gamma_rad;
    signals
}

/// The rates that the motion does not tell: of the accelerations and of the roll split, from the samples.
fn complete_rates(signals: &mut [Signals], dt_s: f64) {
    for sensor in [Sensor::Ax, Sensor::Ay, Sensor::Az, Sensor::RollSplit] {
        let values: Vec<f64> = signals.iter().map(|s| s[sensor]).collect();
        for (signals, rate) in signals.iter_mut().zip(derivative(&values, dt_s)) {
            signals.rate[sensor as usize] = rate;
        }
    }
}

/// Time, place and weather, as effects see them.
fn seen(state: &State) -> Seen {
    Seen {
        t: state.t_s,
        s: state.s_m,
        v: state.v_mps,
        ice_c: state.ice_c,
        air_c: state.air_c,
        air_pa: state.air_pa,
        air_density: state.air_density_kgpm3,
        ..Seen::default()
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
