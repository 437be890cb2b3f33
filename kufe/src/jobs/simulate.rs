//! Simulated runs of one driver on one track.

use std::path::PathBuf;
use std::time::Instant;

use kufe_lut::Point;
use kufe_sled::sample_data::{sample_driver, sample_drivers};
use kufe_sled::{
    CONDITIONS, Conditions, Driver, Model, Run, SimulateOptions, Track, TrackShape, Vehicle,
    outside_tables, record, simulate, simulated_entry, table_samples, together,
};
use rayon::prelude::*;

use crate::jobs::failure::Failure;
use crate::jobs::runs::{load_model, warn_elsewhere};
use crate::jobs::watch::Watch;
use crate::results::{SimulatedRun, Simulation};

/// Number of runs whose samples are collected for the model's tables.
const SAMPLED_RUNS: u32 = 20;

/// A simulation of runs: model, track, driver and options.
#[derive(Clone, Debug)]
pub struct SimulatedDrives {
    /// Sled and friction.
    pub model: PathBuf,
    /// Table of the track.
    pub track: PathBuf,
    /// The driver.
    pub driver: NamedDriver,
    /// Number of runs.
    pub runs: u32,
    /// Name of the session in the index.
    pub session: String,
    /// Whether the sensors have the model's noise.
    pub noise: bool,
    /// Steps, rate, start and conditions; each run adds its number to the seed.
    pub options: SimulateOptions,
}

/// A driver with a name.
#[derive(Clone, Debug)]
pub struct NamedDriver {
    name: String,
    driver: Driver,
}

impl NamedDriver {
    /// A driver of the sample data by `name`, or without a name one of a skill from 0 to 1.
    ///
    /// # Errors
    /// [`Failure::Usage`] for an unknown name and a skill out of range.
    pub fn of(name: Option<&str>, skill: f64) -> Result<NamedDriver, Failure> {
        let (name, driver) = match name {
            None if (0.0..=1.0).contains(&skill) => {
                (format!("skill {skill}"), Driver::of_skill(skill))
            }
            None => return Err(Failure::option("skill", skill, "0 to 1")),
            Some(name) => {
                let known = || sample_drivers().iter().map(|driver| driver.name.as_str());
                if !known().any(|known| known == name) {
                    let known = known().collect::<Vec<_>>().join(", ");
                    return Err(Failure::option(
                        "driver",
                        name,
                        format_args!("one of {known}"),
                    ));
                }
                (name.to_owned(), sample_driver(name).driving)
            }
        };
        Ok(NamedDriver { name, driver })
    }
}

/// Conditions from the values of [`CONDITIONS`] in their order; `None` is not stated (NaN).
///
/// # Errors
/// [`Failure::Usage`] for a value out of range.
pub fn stated_conditions(values: [Option<f64>; 6]) -> Result<Conditions, Failure> {
    for ((name, low, high), value) in CONDITIONS.iter().zip(values) {
        if let Some(value) = value.filter(|value| !(*low..=*high).contains(value)) {
            let option = name.replace('_', "-");
            let expected = format_args!("{low} to {high}");
            return Err(Failure::option(&option, value, expected));
        }
    }
    Ok(Conditions::from_values(
        values.map(|value| value.unwrap_or(f64::NAN)),
    ))
}

/// Simulated runs with their model and track.
pub struct DrivenRuns {
    /// Sled and friction, as the model file states them.
    pub model: Model,
    /// The model with its tables read.
    pub vehicle: Vehicle,
    /// The track.
    pub track: Track,
    /// The runs as their sensors record them.
    pub runs: Vec<Run>,
    /// The document.
    pub document: Simulation,
    /// Samples of the first runs in the tables of the front and the rear runner.
    pub samples: [Vec<Point>; 2],
}

impl SimulatedDrives {
    /// The files that are read.
    pub fn inputs(&self) -> [PathBuf; 2] {
        [self.model.clone(), self.track.clone()]
    }

    /// Drives the runs.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place, and for options out of range.
    pub fn drive(&self, watch: &Watch) -> Result<DrivenRuns, Failure> {
        let begun = Instant::now();
        let (model, vehicle) = load_model(&self.model)?;
        let track = Track::load(&self.track)?;
        let shape = TrackShape::new(&track);
        let conditions = vehicle.conditions.complete(&self.options.conditions);
        warn_elsewhere(&vehicle, &self.model, &[&track.name], watch);
        watch.progress("driving the runs");
        let tabled = vehicle.tables().iter().any(Option::is_some);
        let drive = |number: u32| -> Result<_, Failure> {
            watch.check()?;
            let options = SimulateOptions {
                conditions,
                seed: self.options.seed.wrapping_add(u64::from(number)),
                ..self.options.clone()
            };
            let driver = &self.driver;
            let simulated = simulate(&vehicle, &shape, &driver.driver, &options)?;
            let name = format!("run_{:03}", number + 1);
            let mut entry = simulated_entry(&name, &track, &driver.name, conditions);
            entry.session.clone_from(&self.session);
            let noise = model.noise.as_ref().filter(|_| self.noise);
            let run = record(&simulated, &vehicle, noise, entry, options.seed);
            let states = simulated.instants.iter().map(|instant| &instant.state);
            let energy = &simulated.energy;
            let row = SimulatedRun {
                run: name,
                seed: options.seed,
                finished: simulated.finished,
                time_s: (run.len() - 1) as f64 * run.dt_s,
                energy_balance_relative_error: energy.relative_error(),
                gravity_j: energy.gravity_j,
                ice_j: energy.ice_j,
                air_j: energy.air_j,
                outside_tables: outside_tables(&vehicle, states.clone()),
            };
            let samples = if tabled && number < SAMPLED_RUNS {
                table_samples(states)
            } else {
                Default::default()
            };
            Ok((run, row, samples))
        };
        let driven: Vec<_> = (0..self.runs).into_par_iter().map(drive).collect();
        let (mut runs, mut rows) = (Vec::new(), Vec::new());
        let mut samples = [Vec::new(), Vec::new()];
        for driven in driven {
            let (run, row, of_run) = driven?;
            runs.push(run);
            rows.push(row);
            for (all, of_run) in samples.iter_mut().zip(of_run) {
                all.extend(of_run);
            }
        }
        let outside = rows.iter().flat_map(|row| row.outside_tables.clone());
        for (outside, count) in together(outside.collect()) {
            watch.warn(&format!("{outside}, in {count} of {} runs", self.runs));
        }
        let simulated_s: f64 = runs.iter().map(|run| run.len() as f64 * run.dt_s).sum();
        let document = Simulation {
            runs: rows,
            track: track.name.clone(),
            driver: self.driver.name.clone(),
            times_real_time: simulated_s / begun.elapsed().as_secs_f64(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        Ok(DrivenRuns {
            model,
            vehicle,
            track,
            runs,
            document,
            samples,
        })
    }
}
