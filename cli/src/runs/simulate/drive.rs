//! Runs of one driver on one track.

use std::path::Path;

use kufe::charts::run_picture;
use kufe::jobs::{Failure, runs::failure};
use kufe::results::{SimulatedRun, Simulation};
use kufe_lut::Sample;
use kufe_sled::sample_data::{DRIVERS, sample_driver};
use kufe_sled::{
    Driver, EnergyBalance, Model, OutsideTable, PrepareOptions, Run, SimulateOptions, Track,
    TrackShape, Vehicle, outside_tables, prepare, record, simulate, simulated_entry, table_samples,
    together,
};
use rayon::prelude::*;

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::say::{say, warn};
use crate::runs::series::write_channels;
use crate::runs::simulate::args::Args;
use crate::runs::simulate::written::{write_runs, write_track};
use crate::runs::tables::draw_tables;

/// Runs whose samples are drawn on the model's tables.
const DRAWN: u32 = 20;

/// A run driven: as recorded, its energies, whether it reached the finish, and what lies outside the tables, with what they were asked.
type Driven = (
    Run,
    EnergyBalance,
    bool,
    Vec<OutsideTable>,
    [Vec<Sample>; 2],
);

/// Drives and writes them.
pub fn drive(args: &Args, model_file: &Path, track: &Path, global: &Global) -> Result<(), Failure> {
    let refusal = |error: kufe_sled::Error| failure(&error);
    let inputs = [model_file.to_path_buf(), track.to_path_buf()];
    let model = Model::load(model_file).map_err(refusal)?;
    let vehicle = Vehicle::with_effects(&model).map_err(refusal)?;
    let track = Track::load(track).map_err(refusal)?;
    let shape = TrackShape::new(&track);
    let (driver, driver_name) = driver(args)?;
    let conditions = vehicle.conditions.complete(&args.conditions()?);
    for text in vehicle.effects_elsewhere(&[&track.name]) {
        warn(&format!("{}: {text}", model_file.display()));
    }
    let output = OutputDir::begin("simulate", &inputs, &args.out, global.force)?;
    let bar = global.progress();
    bar.set_message(format!("driving {} runs", args.runs));
    let start = std::time::Instant::now();
    let tabled = vehicle.tables().iter().any(Option::is_some);
    let driven: Vec<Driven> = (0..args.runs)
        .into_par_iter()
        .map(|number| {
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
            let requested = match tabled && number < DRAWN {
                true => table_samples(states),
                false => [Vec::new(), Vec::new()],
            };
            Ok((
                run,
                simulated.energy,
                simulated.finished,
                outside,
                requested,
            ))
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect::<Result<_, _>>()
        .map_err(refusal)?;
    let seconds = start.elapsed().as_secs_f64();
    let simulated_s: f64 = driven
        .iter()
        .map(|(run, ..)| run.len() as f64 * run.dt_s)
        .sum();
    let mut runs: Vec<Run> = Vec::new();
    let mut rows: Vec<SimulatedRun> = Vec::new();
    let mut samples = [Vec::new(), Vec::new()];
    let mut left_tables: Vec<OutsideTable> = Vec::new();
    for (number, (run, energy, finished, outside, requested)) in driven.into_iter().enumerate() {
        left_tables.extend(outside.iter().cloned());
        let seed = args.seed.wrapping_add(number as u64);
        rows.push(SimulatedRun::new(&run, seed, finished, &energy, outside));
        runs.push(run);
        for (all, own) in samples.iter_mut().zip(requested) {
            all.extend(own);
        }
    }
    for (outside, runs) in together(left_tables) {
        warn(&format!("{outside}, in {runs} of {} runs", args.runs));
    }
    let document = Simulation::new(rows, &track.name, &driver_name, simulated_s, seconds);
    bar.set_message("writing");
    write_runs(&output, &mut runs, args.format())?;
    write_track(&output, &track)?;
    if args.mat {
        write_channels(&output, &document, &runs)?;
    }
    let mut pictures = draw_first(&output, &runs, &model, &vehicle)?;
    pictures.extend(draw_tables(&output, &vehicle, &samples)?);
    let json = output.json("simulation.json", &document)?;
    output.commit()?;
    bar.finish_and_clear();
    if global.json {
        say(&json);
    } else if !global.quiet {
        let mut text = String::new();
        for run in document.runs.iter().take(20) {
            text += &format!(
                "{}  {:.2} s{}  energy kept to {:.1e} of it\n",
                run.run,
                run.time_s,
                if run.finished {
                    ""
                } else {
                    ", finish not reached"
                },
                run.energy_balance_relative_error,
            );
        }
        text += &format!(
            "{}: runs.csv, {} run{}, {}, simulation.json{}\n",
            args.out.display(),
            runs.len(),
            if runs.len() == 1 { "" } else { "s" },
            kufe_sled::track_file(&track.name),
            pictures
                .iter()
                .map(|name| format!(", {name}"))
                .collect::<String>()
        );
        say(&text);
    }
    Ok(())
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
