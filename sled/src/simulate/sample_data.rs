//! A sample data set: 44 simulated runs of five drivers on two tracks, with the truth stated.

use crate::friction::GRAVITY;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::conditions::Conditions;
use crate::error::Error;
use crate::model::model_toml::Model;
use crate::model::vehicle::Vehicle;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::simulate::drive::{SimulateOptions, simulate};
use crate::simulate::driver::Driver;
use crate::simulate::dynamics::WallContact;
use crate::simulate::sensors::{record, simulated_entry};
use crate::track::table::{IceAlong, Track, TrackShape};

/// The sample drivers with class and number of runs, as in the paper's table.
pub const DRIVERS: [(&str, &str, usize); 5] = [
    ("A1", "A", 9),
    ("A2", "A", 12),
    ("A3", "A", 7),
    ("B1", "B", 12),
    ("C1", "C", 4),
];

/// How each sample driver steers.
///
/// A1 steers little and lets the sled wander; A2 steers much and stays on the line; A3 and B1 vary
/// more from run to run; C1 steers little and late, and swings between the walls
/// ([`sample_contacts`]).
pub fn sample_driver(name: &str) -> Driver {
    let a1 = Driver {
        noise_rad: 0.006,
        wander_m: 0.10,
        ..Driver::of_skill(0.95)
    };
    match name {
        "A2" => Driver {
            noise_rad: 0.009,
            line_gain: 0.06,
            wander_m: 0.03,
            ..a1
        },
        "A3" => Driver {
            noise_rad: 0.008,
            wander_m: 0.12,
            ..a1
        },
        "B1" => Driver {
            noise_rad: 0.016,
            wander_m: 0.30,
            ..Driver::of_skill(0.6)
        },
        "C1" => Driver {
            feedforward: 0.2,
            line_gain: 0.03,
            course_gain: 0.0,
            lag_s: 0.3,
            most_rad: 0.035,
            noise_rad: 0.012,
            wander_m: 0.6,
            ..Driver::of_skill(0.2)
        },
        _ => a1,
    }
}

/// A sample track: banked curves on a slope, shaped for the speeds that a sled reaches on it.
///
/// `east` has long straights where the sled touches the wall ([`sample_contacts`]); `west` is
/// longer and clean.
pub fn sample_track(name: &str) -> Track {
    // Start of the curve, length, bank at its crown (negative: a left turn, right side up) [m, m,
    // rad].
    let (length, curves): (f64, &[[f64; 3]]) = match name {
        "west" => (
            1500.0,
            &[
                [90.0, 70.0, 0.45],
                [180.0, 90.0, -0.85],
                [300.0, 80.0, 0.95],
                [410.0, 120.0, -1.15],
                [560.0, 90.0, 1.05],
                [680.0, 140.0, -1.25],
                [850.0, 100.0, 1.20],
                [980.0, 110.0, -1.10],
                [1120.0, 150.0, 1.28],
                [1300.0, 100.0, -1.00],
            ],
        ),
        _ => (
            1250.0,
            &[
                [80.0, 60.0, -0.40],
                [160.0, 110.0, 0.90],
                [300.0, 150.0, -1.20],
                [560.0, 90.0, 1.05],
                [670.0, 90.0, -1.10],
                [850.0, 160.0, 1.25],
                [1030.0, 110.0, -1.15],
            ],
        ),
    };
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
        curves.iter().map(of_curve).sum()
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
        name: if name == "west" { "west" } else { "east" }.to_string(),
        slope_rad: s_m.iter().map(|s| slope(*s)).collect(),
        bank_rad: s_m.iter().map(|s| bank(*s)).collect(),
        curvature_1pm,
        s_m,
    }
}

/// Quintic step from 0 at 0 to 1 at 1 with two derivatives zero at both ends.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// Wall contacts of one sample run: on `east` near 500 m and 800 m for everybody; B1 and above all
/// C1 touch elsewhere, too.
pub fn sample_contacts(track: &str, driver: &str, seed: u64) -> Vec<WallContact> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x77a1);
    let mut contact = |s_m: f64, side: f64| WallContact {
        s_m: s_m + random.random_range(-8.0..8.0),
        length_m: random.random_range(10.0..20.0),
        force_n: side * random.random_range(500.0..1100.0),
        x_m: random.random_range(-0.3..0.5),
    };
    let mut contacts = Vec::new();
    if track == "east" {
        contacts.extend([contact(490.0, 1.0), contact(790.0, -1.0)]);
    }
    let elsewhere: &[f64] = match driver {
        "B1" => &[640.0],
        "C1" => &[260.0, 340.0, 560.0, 640.0, 700.0, 910.0, 1000.0, 1120.0],
        _ => &[],
    };
    for (i, s_m) in elsewhere.iter().enumerate() {
        contacts.push(contact(*s_m, if i % 2 == 0 { -1.0 } else { 1.0 }));
    }
    contacts
}

/// One run of the sample data set before it is driven.
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
    /// How it is driven.
    pub options: SimulateOptions,
}

/// The plan of the sample data set: 44 runs, drivers as in the paper, sessions d1 to d4 on `east`
/// and w1 on `west`.
///
/// The top drivers' last two runs and two of B1's are on `west`, which no fit should see.
/// Everything follows from `seed`.
pub fn sample_plan(seed: u64) -> Vec<Planned> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut plan = Vec::new();
    for (driver, driver_class, count) in DRIVERS {
        let away = if driver == "C1" { 0 } else { 2 };
        for i in 0..count {
            let west = i + away >= count;
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
                driver_class,
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

/// Drives one planned run; a driver's line varies from run to run by a factor drawn from the run's
/// seed.
///
/// # Errors
/// Those of [`simulate`].
pub fn drive_planned(
    planned: &Planned,
    model: &Model,
    vehicle: &Vehicle,
    shape: &TrackShape,
    track: &Track,
) -> Result<Run, Error> {
    let mut driver = sample_driver(planned.driver);
    let mut random = ChaCha8Rng::seed_from_u64(planned.options.seed ^ 0xd41e);
    let spread = match planned.driver {
        "A3" | "B1" => 0.5,
        _ => 0.15,
    };
    let form = 1.0 + random.random_range(-spread..spread);
    driver.wander_m *= form;
    driver.noise_rad *= form;
    let simulated = simulate(vehicle, shape, &driver, &planned.options)?;
    let options = &planned.options;
    let entry = Entry {
        driver_class: planned.driver_class.to_string(),
        session: planned.session.clone(),
        ..simulated_entry(&planned.run, track, planned.driver, options.conditions)
    };
    let noise = model.noise.as_ref();
    Ok(record(&simulated, vehicle, noise, entry, options.seed))
}

/// Drives the whole plan, runs in parallel and in order.
///
/// # Errors
/// The first run's error in order.
pub fn drive_sample(plan: &[Planned], model: &Model) -> Result<Vec<Run>, Error> {
    let vehicle = Vehicle::with_effects(model)?;
    let tracks = ["east", "west"].map(sample_track);
    let shapes = [0, 1].map(|i| TrackShape::new(&tracks[i]));
    plan.par_iter()
        .map(|planned| {
            let i = usize::from(planned.track == "west");
            drive_planned(planned, model, &vehicle, &shapes[i], &tracks[i])
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}
