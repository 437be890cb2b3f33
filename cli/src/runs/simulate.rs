//! `kufe simulate`: a sled driven down a track, recorded like a measured run.

use std::io::Write;
use std::path::{Path, PathBuf};

use kufe_jobs::{Failure, runs::failure};
use kufe_sled::plots::run_picture;
use kufe_sled::sample_data::{DRIVERS, drive_sample, sample_driver, sample_plan, sample_track};
use kufe_sled::{
    Conditions, Driver, EnergyBalance, Model, OutsideTable, PrepareOptions, Run, RunFormat,
    SimulateOptions, Track, TrackShape, Vehicle, outside_tables, prepare, record, simulate,
    simulated_entry, write_index, write_run,
};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::output::global::Global;
use crate::output::say::say;
use crate::output::staging::Staging;
use crate::output::watched::warn;
use crate::runs::recorded::begin;
use crate::runs::series::write_channels;

const EXAMPLES: &str = "\
Examples:
  kufe simulate model.toml track.csv -o out/ --runs 4 --seed 7     four runs with the model's sensor noise
  kufe simulate model.toml track.csv --skill 1 --no-noise          a steady driver and perfect sensors
  kufe simulate --sample-data sample/ --seed 1                     44 runs, five drivers, two tracks, stated truth

The track has s_m, slope_rad (positive downhill), curvature_1pm (1/r_y, positive in a valley) and bank_rad (positive with
the left side up). The output is what the other commands read: runs.csv, one file a run, the track.";

/// Arguments of `kufe simulate`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Sled and friction
    #[arg(value_name = "MODEL.toml", required_unless_present = "sample_data")]
    model: Option<PathBuf>,
    /// Track
    #[arg(value_name = "TRACK.csv", required_unless_present = "sample_data")]
    track: Option<PathBuf>,
    /// Folder for the runs
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    out: PathBuf,
    /// Make the sample data set in this folder instead
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["track", "runs", "skill", "driver"])]
    sample_data: Option<PathBuf>,
    /// Seed of drivers and sensors; each run adds its number
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of runs
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Skill of the driver, 0 to 1
    #[arg(long, default_value_t = 0.9)]
    skill: f64,
    /// Drive like this driver of the sample data instead: A1, A2, A3, B1 or C1
    #[arg(long, value_name = "NAME")]
    driver: Option<String>,
    /// Speed at the start [m/s]
    #[arg(long, value_name = "MPS", default_value_t = 10.0)]
    start_speed: f64,
    /// Output rate [Hz]
    #[arg(long, value_name = "HZ", default_value_t = 500.0)]
    rate: f64,
    /// Step of the integration [s]
    #[arg(long, value_name = "S", default_value_t = 1e-3)]
    step: f64,
    /// Longest time [s]
    #[arg(long, value_name = "S", default_value_t = 600.0)]
    most: f64,
    /// Leave the sensors' noise off
    #[arg(long)]
    no_noise: bool,
    /// The runs for MATLAB too, all channels over time: simulation.mat
    #[arg(long, conflicts_with = "sample_data")]
    mat: bool,
    /// Write Parquet instead of CSV
    #[arg(long)]
    parquet: bool,
    /// Ice temperature [degrees Celsius]
    #[arg(long, default_value_t = -8.0, allow_negative_numbers = true)]
    ice_c: f64,
    /// Air temperature [degrees Celsius]
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    air_c: f64,
    /// Air pressure [Pa]
    #[arg(long, default_value_t = 95_000.0)]
    air_pa: f64,
    /// Relative humidity [%], for effects that ask for it; else from the model's [conditions]
    #[arg(long, value_name = "PCT")]
    humidity_pct: Option<f64>,
    /// Distance run on this finish of the runners before the run [m], likewise
    #[arg(long, value_name = "M")]
    distance_m: Option<f64>,
    /// Name of the session in runs.csv
    #[arg(long, default_value = "1")]
    session: String,
}

/// Simulates and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match (&args.sample_data, &args.model, &args.track) {
        (Some(folder), model, _) => sample(args, folder, model.as_deref(), global),
        (None, Some(model), Some(track)) => drive(args, model, track, global),
        _ => Err(Failure::Usage(
            "a model and a track are needed, or --sample-data".to_string(),
        )),
    }
}

fn drive(args: &Args, model: &Path, track: &Path, global: &Global) -> Result<(), Failure> {
    let told = |error: kufe_sled::Error| failure(&error);
    let inputs = [model.to_path_buf(), track.to_path_buf()];
    let model = Model::load(model).map_err(told)?;
    let vehicle = Vehicle::with_effects(&model).map_err(told)?;
    let track = Track::load(track).map_err(told)?;
    let shape = TrackShape::new(&track);
    let (driver, driver_name) = driver(args)?;
    let conditions = conditions(args)?.or(&vehicle.conditions);
    let names = [
        "runs.csv".to_owned(),
        format!("track_{}.csv", track.name),
        "simulation.json".to_owned(),
        "overview.png".to_owned(),
        "simulation.mat".to_owned(),
    ];
    let staging = begin(&inputs, &args.out, &names)?;
    staging.remove_on_interrupt();
    let bar = global.progress();
    bar.set_message(format!("driving {} runs", args.runs));
    let start = std::time::Instant::now();
    let driven: Vec<(Run, EnergyBalance, bool, Vec<OutsideTable>)> = (0..args.runs)
        .into_par_iter()
        .map(|number| {
            let options = SimulateOptions {
                step_s: args.step,
                rate_hz: args.rate,
                start_speed_mps: args.start_speed,
                most_s: args.most,
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
            let outside = outside_tables(&vehicle, states);
            Ok((run, simulated.energy, simulated.finished, outside))
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect::<Result<_, _>>()
        .map_err(told)?;
    let seconds = start.elapsed().as_secs_f64();
    let simulated_s: f64 = driven
        .iter()
        .map(|(run, ..)| run.len() as f64 * run.dt_s)
        .sum();
    let mut runs: Vec<Run> = Vec::new();
    let mut told_runs: Vec<Value> = Vec::new();
    for (number, (run, energy, finished, outside)) in driven.into_iter().enumerate() {
        told_runs.push(json!({
            "run": run.entry.run,
            "seed": args.seed.wrapping_add(number as u64),
            "finished": finished,
            "time_s": (run.len() - 1) as f64 * run.dt_s,
            "energy_balance_relative_error": energy.relative_error(),
            "gravity_j": energy.gravity_j,
            "ice_j": energy.ice_j,
            "air_j": energy.air_j,
            "outside_tables": outside,
        }));
        for outside in outside {
            warn(&format!("{}: {outside}", run.entry.run));
        }
        runs.push(run);
    }
    let document = json!({
        "runs": told_runs,
        "track": track.name,
        "driver": driver_name,
        "times_real_time": simulated_s / seconds,
        "version": env!("CARGO_PKG_VERSION"),
    });
    bar.set_message("writing");
    write_runs(&staging, &mut runs, format(args))?;
    write_track(&staging, &track)?;
    staging.write("simulation.json", |mut file| writeln!(file, "{document:#}"))?;
    if args.mat {
        write_channels(&staging, &document, &runs)?;
    }
    let picture = draw_first(&staging, &runs, &model, &vehicle)?;
    staging.commit()?;
    bar.finish_and_clear();
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        let mut text = String::new();
        for run in told_runs.iter().take(20) {
            text += &format!(
                "{}  {:.2} s{}  energy balance closed to {:.1e}\n",
                run["run"].as_str().unwrap_or_default(),
                run["time_s"].as_f64().unwrap_or_default(),
                if run["finished"] == true {
                    ""
                } else {
                    ", finish not reached"
                },
                run["energy_balance_relative_error"]
                    .as_f64()
                    .unwrap_or_default(),
            );
        }
        text += &format!(
            "{}: runs.csv, {} runs, track_{}.csv, simulation.json{picture}\n",
            args.out.display(),
            runs.len(),
            track.name
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

fn conditions(args: &Args) -> Result<Conditions, Failure> {
    for (name, value, low, high) in [
        ("--ice-c", args.ice_c, -60.0, 5.0),
        ("--air-c", args.air_c, -60.0, 50.0),
        ("--air-pa", args.air_pa, 50e3, 110e3),
        (
            "--humidity-pct",
            args.humidity_pct.unwrap_or(0.0),
            0.0,
            100.0,
        ),
        ("--distance-m", args.distance_m.unwrap_or(0.0), 0.0, 1e8),
    ] {
        if !(low..=high).contains(&value) {
            return Err(Failure::Usage(format!(
                "{name} {value}: expected {low} to {high}"
            )));
        }
    }
    Ok(Conditions {
        ice_c: args.ice_c,
        air_c: args.air_c,
        air_pa: args.air_pa,
        humidity_pct: args.humidity_pct,
        distance_m: args.distance_m,
    })
}

fn format(args: &Args) -> RunFormat {
    if args.parquet {
        RunFormat::Parquet
    } else {
        RunFormat::Csv
    }
}

/// Writes the runs and, last, the index; names each run's file.
fn write_runs(staging: &Staging, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
    for run in runs.iter_mut() {
        run.entry.file = PathBuf::from(format!("{}.{}", run.entry.run, format.extension()));
    }
    runs.par_iter()
        .map(|run| {
            let name = run.entry.file.display().to_string();
            staging.write(&name, |mut file| write_run(run, &mut file, format))
        })
        .collect::<Result<Vec<()>, Failure>>()?;
    let entries: Vec<_> = runs.iter().map(|run| run.entry.clone()).collect();
    staging.write("runs.csv", |file| write_index(file, &entries))
}

fn write_track(staging: &Staging, track: &Track) -> Result<(), Failure> {
    let name = format!("track_{}.csv", track.name);
    staging.write(&name, |file| track.write_csv(std::io::BufWriter::new(file)))
}

/// Draws the first run where it is long enough to be prepared; names the picture for the summary.
fn draw_first(
    staging: &Staging,
    runs: &[Run],
    model: &Model,
    vehicle: &Vehicle,
) -> Result<&'static str, Failure> {
    let options = PrepareOptions::default();
    let Ok(prepared) = prepare(&runs[0], vehicle, model.noise.as_ref(), &options) else {
        return Ok("");
    };
    run_picture(&staging.path("overview.png"), &prepared)
        .map_err(|error| staging.failure("overview.png", &error))?;
    Ok(", overview.png")
}

fn sample(
    args: &Args,
    folder: &Path,
    model_file: Option<&Path>,
    global: &Global,
) -> Result<(), Failure> {
    let told = |error: kufe_sled::Error| failure(&error);
    let model = match model_file {
        Some(path) => Model::load(path).map_err(told)?,
        None => Model::published(),
    };
    let inputs: Vec<PathBuf> = model_file.map(Path::to_path_buf).into_iter().collect();
    let names = [
        "runs.csv",
        "track_east.csv",
        "track_west.csv",
        "model.toml",
        "truth.json",
    ];
    let staging = begin(&inputs, folder, &names)?;
    staging.remove_on_interrupt();
    let bar = global.progress();
    bar.set_message("driving 44 runs");
    let plan = sample_plan(args.seed);
    let mut runs = drive_sample(&plan, &model).map_err(told)?;
    bar.set_message("writing");
    write_runs(&staging, &mut runs, format(args))?;
    for name in ["east", "west"] {
        write_track(&staging, &sample_track(name))?;
    }
    staging.write("model.toml", |mut file| {
        file.write_all(model.to_toml().as_bytes())
    })?;
    let truth = json!({
        "seed": args.seed,
        "model": "model.toml is the truth that the runs were driven with",
        "drivers": DRIVERS.iter().map(|(name, class, count)| {
            let driver = sample_driver(name);
            json!({
                "driver": name, "class": class, "runs": count,
                "feedforward": driver.feedforward, "preview_s": driver.preview_s,
                "line_gain_rad_per_m": driver.line_gain, "course_gain": driver.course_gain,
                "lag_s": driver.lag_s, "most_rad": driver.most_rad,
                "noise_rad": driver.noise_rad, "wander_m": driver.wander_m, "length_m": driver.length_m,
            })
        }).collect::<Vec<_>>(),
        "runs": plan.iter().map(|run| json!({
            "run": run.run, "track": run.track, "session": run.session,
            "seed": run.options.seed, "start_speed_mps": run.options.start_speed_mps,
            "wall_contacts": run.options.contacts.iter().map(|contact| json!({
                "s_m": contact.s_m, "length_m": contact.length_m,
                "force_n": contact.force_n, "x_m": contact.x_m,
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "version": env!("CARGO_PKG_VERSION"),
    });
    staging.write("truth.json", |mut file| writeln!(file, "{truth:#}"))?;
    staging.commit()?;
    bar.finish_and_clear();
    if global.json {
        say(&format!("{truth:#}\n"));
    } else if !global.quiet {
        say(&format!(
            "{}: runs.csv, {} runs, track_east.csv, track_west.csv, model.toml and truth.json (what they were driven with)\n",
            folder.display(),
            runs.len()
        ));
    }
    Ok(())
}
