//! Runs of one driver on one track.

use std::path::Path;

use kufe::charts::run_picture;
use kufe::jobs::{Failure, channel_series, runs::failure};
use kufe::results::{SimulatedRun, Simulation};
use kufe_lut::Sample;
use kufe_sled::sample_data::{DRIVERS, sample_driver};
use kufe_sled::{
    Driver, Model, PrepareOptions, Run, SimulateOptions, Track, TrackShape, Vehicle,
    outside_tables, prepare, record, simulate, simulated_entry, table_samples, together,
};
use rayon::prelude::*;

use crate::output::OutputDir;
use crate::runs::files::{draw_tables, run_format, write_mat, write_runs, write_track};
use crate::runs::simulate::Args;
use crate::terminal::{Global, warn, warn_if_cut};

/// Runs whose samples are drawn on the model's tables.
const DRAWN: u32 = 20;

/// A simulated run as recorded, and what belongs to it.
struct Driven {
    run: Run,
    row: SimulatedRun,
    /// Its samples on the tables of both runners, where they are drawn.
    samples: [Vec<Sample>; 2],
}

/// Drives the runs and writes them.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(args: &Args, model_file: &Path, track: &Path, global: &Global) -> Result<(), Failure> {
    let inputs = [model_file.to_path_buf(), track.to_path_buf()];
    let model = Model::load(model_file).map_err(failure)?;
    let vehicle = Vehicle::with_effects(&model).map_err(failure)?;
    warn_if_cut(track);
    let track = Track::load(track).map_err(failure)?;
    let shape = TrackShape::new(&track);
    let (driver, driver_name) = driver(args)?;
    let conditions = vehicle.conditions.complete(&args.conditions()?);
    for text in vehicle.effects_elsewhere(&[&track.name]) {
        warn(&format!("{}: {text}", model_file.display()));
    }
    let output = OutputDir::begin("simulate", &inputs, &args.out, global.force)?;
    let start = std::time::Instant::now();
    let tabled = vehicle.tables().iter().any(Option::is_some);
    let drive = |number: u32| -> Result<Driven, kufe_sled::Error> {
        let options = SimulateOptions {
            step_s: args.step_s,
            rate_hz: args.rate_hz,
            start_speed_mps: args.start_speed_mps,
            most_s: args.most_s,
            conditions,
            seed: args.seed.wrapping_add(u64::from(number)),
            ..SimulateOptions::default()
        };
        let simulated = simulate(&vehicle, &shape, &driver, &options)?;
        let name = format!("run_{:03}", number + 1);
        let mut entry = simulated_entry(&name, &track, &driver_name, conditions);
        entry.session.clone_from(&args.session);
        let noise = model.noise.as_ref().filter(|_| !args.no_noise);
        let run = record(&simulated, &vehicle, noise, entry, options.seed);
        let states = simulated.instants.iter().map(|instant| &instant.state);
        let outside = outside_tables(&vehicle, states.clone());
        let (finished, energy) = (simulated.finished, &simulated.energy);
        Ok(Driven {
            row: SimulatedRun::new(&run, options.seed, finished, energy, outside),
            run,
            samples: if tabled && number < DRAWN {
                table_samples(states)
            } else {
                [Vec::new(), Vec::new()]
            },
        })
    };
    let driven = global.during("driving the runs", || {
        let driven: Vec<_> = (0..args.runs).into_par_iter().map(drive).collect();
        driven.into_iter().collect::<Result<Vec<Driven>, _>>()
    });
    let seconds = start.elapsed().as_secs_f64();
    let (mut runs, mut rows) = (Vec::new(), Vec::new());
    let mut samples = [Vec::new(), Vec::new()];
    for driven in driven.map_err(failure)? {
        runs.push(driven.run);
        rows.push(driven.row);
        for (all, own) in samples.iter_mut().zip(driven.samples) {
            all.extend(own);
        }
    }
    let outside = rows.iter().flat_map(|row| row.outside_tables.clone());
    for (outside, runs) in together(outside.collect()) {
        warn(&format!("{outside}, in {runs} of {} runs", args.runs));
    }
    let simulated_s: f64 = runs.iter().map(|run| run.len() as f64 * run.dt_s).sum();
    let document = Simulation::new(rows, &track.name, &driver_name, simulated_s, seconds);
    write_runs(&output, &mut runs, run_format(args.parquet))?;
    write_track(&output, &track)?;
    if args.mat {
        write_mat(&output, "simulation.mat", &document, channel_series(&runs))?;
    }
    let mut pictures = draw_first(&output, &runs, &model, &vehicle)?;
    pictures.extend(draw_tables(&output, &vehicle, &samples)?);
    output.json("simulation.json", &document)?;
    output.commit()?;
    global.print(&document, || {
        let mut text = String::new();
        for run in document.runs.iter().take(20) {
            let finish = if run.finished {
                ""
            } else {
                ", finish not reached"
            };
            text += &format!(
                "{}  {:.2} s{finish}  relative error of the energy balance {:.1e}\n",
                run.run, run.time_s, run.energy_balance_relative_error,
            );
        }
        let plural = if runs.len() == 1 { "" } else { "s" };
        let pictures: String = pictures.iter().map(|name| format!(", {name}")).collect();
        text + &format!(
            "{}: runs.csv, {} run{plural}, {}, simulation.json{pictures}\n",
            args.out.display(),
            runs.len(),
            kufe_sled::track_file(&track.name),
        )
    })
}

fn driver(args: &Args) -> Result<(Driver, String), Failure> {
    if let Some(name) = &args.driver {
        if !DRIVERS.iter().any(|(known, ..)| known == name) {
            let known: Vec<&str> = DRIVERS.iter().map(|(name, ..)| *name).collect();
            return Err(Failure::Usage(format!(
                "--driver {name}: expected one of {}",
                known.join(", ")
            )));
        }
        return Ok((sample_driver(name), name.clone()));
    }
    if !(0.0..=1.0).contains(&args.skill) {
        return Err(Failure::Usage(format!(
            "--skill {}: expected 0 to 1",
            args.skill
        )));
    }
    Ok((
        Driver::of_skill(args.skill),
        format!("skill {}", args.skill),
    ))
}

/// Draws the first run where it is long enough to be prepared; names the picture for the summary.
fn draw_first(
    output: &OutputDir,
    runs: &[Run],
    model: &Model,
    vehicle: &Vehicle,
) -> Result<Vec<String>, Failure> {
    let options = PrepareOptions::default();
    let Ok(prepared) = prepare(&runs[0], vehicle, model.noise.as_ref(), &options) else {
        return Ok(Vec::new());
    };
    output.picture("overview.png", &run_picture(&prepared))?;
    Ok(vec!["overview.png".to_owned()])
}
