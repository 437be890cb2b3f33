//! A sample data set: 44 simulated runs of five drivers on two tracks, with the truth stated.

use std::sync::LazyLock;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Deserialize;

use crate::conditions::Conditions;
use crate::error::Error;
use crate::friction::GRAVITY;
use crate::model::model_toml::Model;
use crate::model::vehicle::Vehicle;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::simulate::drive::{SimulateOptions, simulate};
use crate::simulate::driver::Driver;
use crate::simulate::dynamics::WallContact;
use crate::simulate::sensors::{record, simulated_entry};
use crate::track::table::{IceAlong, Track, TrackShape};

/// A driver of the sample data set.
#[derive(Clone, Debug, Deserialize)]
pub struct SampleDriver {
    /// Name.
    pub name: String,
    /// Class.
    pub class: String,
    /// Number of runs.
    pub runs: usize,
    /// Steering law.
    pub driving: Driver,
    /// Relative variation of wander and noise from run to run.
    #[serde(rename = "varies")]
    variation: f64,
    /// Places where this driver touches the wall, in addition to the places of the track [m].
    #[serde(default)]
    walls_m: Vec<f64>,
}

#[derive(Deserialize)]
struct SampleTrack {
    name: String,
    length_m: f64,
    /// Places where everybody touches the wall [m].
    #[serde(default)]
    walls_m: Vec<f64>,
    /// Start of each curve, its length and the bank at its crown [m, m, rad].
    curves: Vec<[f64; 3]>,
}

#[derive(Deserialize)]
struct Sample {
    driver: Vec<SampleDriver>,
    track: Vec<SampleTrack>,
}

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let sample = toml::from_str(include_str!("../../assets/sample.toml"));
    sample.expect("a table of drivers and tracks")
});

/// The sample drivers.
pub fn sample_drivers() -> &'static [SampleDriver] {
    &SAMPLE.driver
}

/// The sample driver of this name, A1 for an unknown one.
pub fn sample_driver(name: &str) -> &'static SampleDriver {
    let drivers = sample_drivers();
    let known = drivers.iter().find(|driver| driver.name == name);
    known.unwrap_or(&drivers[0])
}

fn track_of(name: &str) -> &'static SampleTrack {
    let known = SAMPLE.track.iter().find(|track| track.name == name);
    known.unwrap_or(&SAMPLE.track[0])
}

/// A sample track (`east` for an unknown name): banked curves on a slope, with curvatures that suit
/// the speed of a sled.
pub fn sample_track(name: &str) -> Track {
    let sample = track_of(name);
    let length = sample.length_m;
    let rows = length as usize + 1;
    let s_m: Vec<f64> = (0..rows).map(|i| i as f64).collect();
    let wave = |s: f64, period: f64| (std::f64::consts::TAU * s / period).sin();
    let slope = |s: f64| {
        // Steep after the start, flat towards the finish.
        let along = s / length;
        0.125 - 0.07 * along * along + 0.02 * wave(s, 310.0) + 0.012 * wave(s, 173.0)
    };
    let bank = |s: f64| -> f64 {
        let of_curve = |[start, extent, crown]: &[f64; 3]| {
            let ramp = 0.38 * extent;
            let rise = smooth_step((s - start) / ramp);
            let fall = smooth_step((start + extent - s) / ramp);
            crown * rise * fall
        };
        sample.curves.iter().map(of_curve).sum()
    };
    let mut speed_square: f64 = 100.0;
    let mut curvature_1pm = Vec::with_capacity(rows);
    for &s in &s_m {
        let phi = bank(s);
        let slope_growth = (slope(s + 0.5) - slope(s - 0.5)) / 1.0;
        // A turn without lateral force: v^2 / r_y = g tan(phi) sin(phi) about the sled's pitch
        // axis.
        curvature_1pm
            .push(GRAVITY * phi.tan() * phi.sin() / speed_square - slope_growth * phi.cos());
        let drag = 0.004 * GRAVITY / phi.cos() + 0.5 * 1.2 * 0.28 * speed_square / 390.0;
        speed_square += 2.0 * (GRAVITY * slope(s).sin() - drag);
    }
    Track {
        ice: IceAlong::default(),
        name: sample.name.clone(),
        slope_rad: s_m.iter().map(|s| slope(*s)).collect(),
        bank_rad: s_m.iter().map(|s| bank(*s)).collect(),
        curvature_1pm,
        s_m,
    }
}

/// Quintic step from 0 at 0 to 1 at 1, with two vanishing derivatives at both ends.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// Wall contacts of one sample run, near the places of the track and of the driver.
pub fn sample_contacts(track: &str, driver: &str, seed: u64) -> Vec<WallContact> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x77a1);
    let mut contact = |s_m: f64, side: f64| WallContact {
        s_m: s_m + random.random_range(-8.0..8.0),
        length_m: random.random_range(10.0..20.0),
        force_n: side * random.random_range(500.0..1100.0),
        x_m: random.random_range(-0.3..0.5),
    };
    let mut contacts = Vec::new();
    let of_track = (&track_of(track).walls_m, 1.0);
    for (places, first_side) in [of_track, (&sample_driver(driver).walls_m, -1.0)] {
        for (i, s_m) in places.iter().enumerate() {
            let side = if i % 2 == 0 { first_side } else { -first_side };
            contacts.push(contact(*s_m, side));
        }
    }
    contacts
}

/// Plan of one run of the sample data set.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Name of the run.
    pub run: String,
    /// Track.
    pub track: &'static str,
    /// Driver.
    pub driver: &'static str,
    /// Class of the driver.
    pub driver_class: &'static str,
    /// Session.
    pub session: String,
    /// Options of the simulation.
    pub options: SimulateOptions,
}

/// The plan of the sample data set: 44 runs, drivers as in the paper, sessions d1 to d4 on `east`
/// and w1 on `west`.
///
/// The top drivers' last two runs and two of B1's are on `west`, which no fit should use.
/// Everything follows from `seed`.
pub fn sample_plan(seed: u64) -> Vec<Planned> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut plan = Vec::new();
    for sample in sample_drivers() {
        let (driver, class, runs) = (&sample.name, &sample.class, sample.runs);
        let away = if driver == "C1" { 0 } else { 2 };
        for i in 0..runs {
            let west = i + away >= runs;
            let day = i % 4;
            let own_day = format!("d{}", day + 1);
            let session = if west { "w1".to_string() } else { own_day };
            let run_seed: u64 = random.random();
            let track = if west { "west" } else { "east" };
            let warm = if west { 1.5 } else { day as f64 };
            plan.push(Planned {
                run: format!("{driver}-{:02}", i + 1),
                track,
                driver,
                driver_class: class,
                session,
                options: SimulateOptions {
                    start_speed_mps: random.random_range(9.6..10.4),
                    conditions: Conditions {
                        ice_c: -9.0 + 1.5 * warm,
                        air_c: -4.0 + 2.0 * warm,
                        air_pa: 94_500.0 + 300.0 * warm,
                        ..Conditions::UNSTATED
                    },
                    contacts: sample_contacts(track, driver, run_seed),
                    seed: run_seed,
                    ..SimulateOptions::default()
                },
            });
        }
    }
    plan
}

/// Simulates the plan, runs in parallel and in order. Wander and noise of a driver vary from run to
/// run by a factor drawn from the run's seed.
///
/// # Errors
/// The first run's error in order.
pub fn drive_sample(plan: &[Planned], model: &Model) -> Result<Vec<Run>, Error> {
    let vehicle = Vehicle::with_effects(model)?;
    let tracks = ["east", "west"].map(sample_track);
    let shapes = [0, 1].map(|i| TrackShape::new(&tracks[i]));
    let drive = |planned: &Planned| {
        let (sample, options) = (sample_driver(planned.driver), &planned.options);
        let mut driver = sample.driving;
        let mut random = ChaCha8Rng::seed_from_u64(options.seed ^ 0xd41e);
        let factor = 1.0 + random.random_range(-sample.variation..sample.variation);
        driver.wander_m *= factor;
        driver.noise_rad *= factor;
        let i = usize::from(planned.track == "west");
        let simulated = simulate(&vehicle, &shapes[i], &driver, options)?;
        let entry = Entry {
            driver_class: planned.driver_class.to_string(),
            session: planned.session.clone(),
            ..simulated_entry(&planned.run, &tracks[i], planned.driver, options.conditions)
        };
        let noise = model.noise.as_ref();
        Ok(record(&simulated, &vehicle, noise, entry, options.seed))
    };
    let driven: Vec<Result<Run, Error>> = plan.par_iter().map(drive).collect();
    driven.into_iter().collect()
}
