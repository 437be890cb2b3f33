//! `kufe simulate`: simulated runs, recorded like measured ones, and replays of measured runs.

use std::path::{Path, PathBuf};

use kufe::charts::{replay_picture, run_picture};
use kufe::jobs::replay::{ReplayedDrive, entry_on_track};
use kufe::jobs::runs::{run_format, run_inputs, write_runs, write_track};
use kufe::jobs::simulate::{DrivenRuns, NamedDriver, SimulatedDrives, stated_conditions};
use kufe::jobs::view_runs::ViewOptions;
use kufe::jobs::{Failure, channel_series};
use kufe::plot::quantity;
use kufe::results::SampleTruth;
use kufe_sled::sample_data::{drive_sample, sample_plan, sample_track};
use kufe_sled::{
    Conditions, Entry, Model, PrepareOptions, Replay, SimulateOptions, Track, prepare,
    table_samples,
};

use crate::output::OutputDir;
use crate::runs::{all_runs, draw_tables, write_mat, write_view};
use crate::terminal::{Global, warn, warn_if_cut};
use crate::text::{document_text, table_text};

/// Largest number of runs that are printed; the document has all.
const MAX_LISTED: usize = 20;

/// Arguments of `kufe simulate`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Model of the sled and its friction
    #[arg(value_name = "MODEL.toml", required_unless_present = "sample_data")]
    pub model: Option<PathBuf>,
    /// Track
    #[arg(value_name = "TRACK.csv", required_unless_present = "sample_data")]
    pub track: Option<PathBuf>,
    /// Folder for the runs
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Make the sample data set in this folder instead
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["track", "runs", "skill", "driver"])]
    pub sample_data: Option<PathBuf>,
    /// Drive with the start and the steering of a measured run: its file, or a runs.csv together
    /// with --run
    #[arg(long, value_name = "RUN", conflicts_with_all = ["sample_data", "runs", "skill", "driver", "seed", "start_speed_mps", "no_noise"])]
    pub replay: Option<PathBuf>,
    /// Name of the run in runs.csv
    #[arg(long, value_name = "NAME", requires = "replay")]
    pub run: Option<String>,
    /// Write view.html too, the page of kufe runs view with this run: the page of kufe report links
    /// into it
    #[arg(long, requires = "run")]
    pub view: bool,
    /// Refuse runs with missing files, values or rows, uneven times or standstill, instead of
    /// excluding them
    #[arg(long, requires = "replay")]
    pub strict: bool,
    /// Seed of drivers and sensors; each run adds its number
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Number of runs
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
    /// Skill of the driver, 0 to 1
    #[arg(long, default_value_t = 0.9)]
    pub skill: f64,
    /// Drive like this driver of the sample data instead: A1, A2, A3, B1 or C1
    #[arg(long, value_name = "NAME")]
    pub driver: Option<String>,
    /// Speed at the start [m/s]
    #[arg(long, value_name = "M_PER_S", default_value_t = 10.0)]
    pub start_speed_mps: f64,
    /// Output rate [Hz]
    #[arg(long, value_name = "HZ", default_value_t = 500.0)]
    pub rate_hz: f64,
    /// Step of the integration [s]
    #[arg(long, value_name = "S", default_value_t = 1e-3)]
    pub step_s: f64,
    /// Longest time [s]
    #[arg(long, value_name = "S", default_value_t = 600.0)]
    pub most_s: f64,
    /// Leave the sensors' noise off
    #[arg(long)]
    pub no_noise: bool,
    /// The runs for MATLAB too, all channels over time: simulation.mat
    #[arg(long, conflicts_with = "sample_data")]
    pub mat: bool,
    /// Write Parquet instead of CSV
    #[arg(long)]
    pub parquet: bool,
    /// Ice temperature [degrees Celsius], if the track states no ice_c
    #[arg(long, value_name = "CELSIUS", default_value_t = -8.0, allow_negative_numbers = true)]
    pub ice_c: f64,
    /// Air temperature [degrees Celsius]
    #[arg(long, value_name = "CELSIUS")]
    #[arg(default_value_t = 0.0, allow_negative_numbers = true)]
    pub air_c: f64,
    /// Air pressure [Pa]
    #[arg(long, value_name = "PA", default_value_t = 95_000.0)]
    pub air_pa: f64,
    /// Relative humidity [%], for effects that need it; else from the model's [conditions]
    #[arg(long, value_name = "PCT")]
    pub humidity_pct: Option<f64>,
    /// Distance run with the present surface finish of the runners before the run [m], for effects
    /// that need it; else from the model's [conditions]
    #[arg(long, value_name = "METRES")]
    pub distance_m: Option<f64>,
    /// Name of the session in runs.csv
    #[arg(long, default_value = "1")]
    pub session: String,
}

impl Args {
    /// Step, rate, largest time and start speed.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a value out of range.
    fn steps(&self) -> Result<SimulateOptions, Failure> {
        let options = SimulateOptions {
            step_s: self.step_s,
            rate_hz: self.rate_hz,
            most_s: self.most_s,
            start_speed_mps: self.start_speed_mps,
            ..SimulateOptions::default()
        };
        match options.out_of_range() {
            None => Ok(options),
            Some((key, value, [low, high])) => {
                let expected = format_args!("{low} to {high}");
                Err(Failure::option(&key.replace('_', "-"), value, expected))
            }
        }
    }

    /// Conditions of ice and air from the options.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a value out of range.
    fn conditions(&self) -> Result<Conditions, Failure> {
        let [ice_c, air_c, air_pa] = [self.ice_c, self.air_c, self.air_pa].map(Some);
        let (humidity_pct, distance_m) = (self.humidity_pct, self.distance_m);
        stated_conditions([ice_c, air_c, air_pa, humidity_pct, distance_m, None])
    }
}

/// Simulates and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match (&args.sample_data, &args.model, &args.track) {
        (Some(folder), model, _) => sample(args, folder, model.as_deref(), global),
        (None, Some(model), Some(track)) => match &args.replay {
            Some(file) => replay(args, model, track, file, global),
            None => drive(args, model, track, global),
        },
        _ => Err(Failure::Usage(
            "a model and a track are needed, or --sample-data".to_string(),
        )),
    }
}

/// Drives runs of one driver on one track and writes them.
fn drive(args: &Args, model: &Path, track: &Path, global: &Global) -> Result<(), Failure> {
    let drives = SimulatedDrives {
        model: model.to_path_buf(),
        track: track.to_path_buf(),
        driver: NamedDriver::of(args.driver.as_deref(), args.skill)?,
        runs: args.runs,
        session: args.session.clone(),
        noise: !args.no_noise,
        options: SimulateOptions {
            conditions: args.conditions()?,
            seed: args.seed,
            ..args.steps()?
        },
    };
    warn_if_cut(track);
    let output = OutputDir::begin("simulate", &drives.inputs(), &args.out, global.force)?;
    let DrivenRuns {
        model,
        vehicle,
        track,
        mut runs,
        document,
        samples,
    } = global.watched(|watch| drives.drive(watch))?;
    write_runs(&output, &mut runs, run_format(args.parquet))?;
    write_track(&output, &track)?;
    if args.mat {
        write_mat(&output, "simulation.mat", &document, channel_series(&runs))?;
    }
    // The first run is drawn if it is long enough to be prepared.
    let noise = model.noise.as_ref();
    if let Ok(prepared) = prepare(&runs[0], &vehicle, noise, &PrepareOptions::default()) {
        output.picture("overview.png", &run_picture(&prepared))?;
    }
    draw_tables(&output, &vehicle, &samples)?;
    for run in document.runs.iter().filter(|run| !run.finished) {
        let (run, most) = (&run.run, args.most_s);
        warn(&format!(
            "run {run} is not at the finish after {most} s (--most-s)"
        ));
    }
    let listed = &document.runs[..document.runs.len().min(MAX_LISTED)];
    let text = table_text(
        &listed,
        &["run", "time_s", "finished", "energy_balance_relative_error"],
    )?;
    output.finish("simulation.json", &document, global, || text)
}

/// Replays the measured run of `file` and writes the result with the measurement.
fn replay(
    args: &Args,
    model: &Path,
    track_file: &Path,
    file: &Path,
    global: &Global,
) -> Result<(), Failure> {
    let track = Track::load(track_file)?;
    let mut inputs: Vec<PathBuf> = vec![model.to_path_buf(), track_file.to_path_buf()];
    inputs.extend(run_inputs(file));
    let drive = ReplayedDrive {
        model: model.to_path_buf(),
        entry: entry(args, file, &track)?,
        track,
        strict: args.strict,
        options: args.steps()?,
    };
    let output = OutputDir::begin("simulate --replay", &inputs, &args.out, global.force)?;
    let mut replayed = global.watched(|watch| drive.drive(watch))?;
    let run = std::slice::from_mut(&mut replayed.driven);
    write_runs(&output, run, run_format(args.parquet))?;
    write_track(&output, &drive.track)?;
    let document = replayed.document();
    let done = &replayed.replay;
    if args.mat {
        let series = channel_series(std::slice::from_ref(&replayed.driven));
        write_mat(&output, "simulation.mat", &document, series)?;
    }
    output.picture("replay.png", &replay_picture(done))?;
    let states = done.simulated.instants.iter().map(|instant| &instant.state);
    draw_tables(&output, &replayed.vehicle, &table_samples(states))?;
    let viewed = args.run.clone().filter(|_| args.view);
    let viewed = viewed.map(|run| ViewOptions {
        model: Some(model.to_path_buf()),
        track: Some(track_file.to_path_buf()),
        only: vec![run],
        ..all_runs(file.to_path_buf())
    });
    write_view(&output, viewed, global)?;
    let summary = summary(done)?;
    output.finish("simulation.json", &document, global, || summary)
}

/// Makes the sample data set and writes it.
fn sample(
    args: &Args,
    folder: &Path,
    model_file: Option<&Path>,
    global: &Global,
) -> Result<(), Failure> {
    let model = model_file.map_or_else(|| Ok(Model::published()), Model::load)?;
    let inputs: Vec<PathBuf> = model_file.map(Path::to_path_buf).into_iter().collect();
    let command = "simulate --sample-data";
    let output = OutputDir::begin(command, &inputs, folder, global.force)?;
    let plan = sample_plan(args.seed);
    let mut runs = global.during("driving 44 runs", || drive_sample(&plan, &model))?;
    write_runs(&output, &mut runs, run_format(args.parquet))?;
    for name in ["east", "west"] {
        write_track(&output, &sample_track(name))?;
    }
    output.bytes("model.toml", model.to_toml())?;
    let truth = SampleTruth::new(args.seed, &plan);
    output.finish("truth.json", &truth, global, || {
        let count = runs.len();
        format!("{count} runs; truth.json has what they were driven with\n")
    })
}

/// The row of the run: that of the index which `--run` names, otherwise one made from the options.
fn entry(args: &Args, file: &Path, track: &Track) -> Result<Entry, Failure> {
    let Some(name) = &args.run else {
        let stem = file.file_stem().unwrap_or_default();
        return Ok(Entry {
            run: stem.to_string_lossy().into_owned(),
            file: file.to_path_buf(),
            track: track.name.clone(),
            driver: "measured".to_owned(),
            driver_class: "measured".to_owned(),
            session: args.session.clone(),
            conditions: args.conditions()?,
            ..Entry::default()
        });
    };
    entry_on_track(file, name, track)
}

/// The differences by column, and the stretches where the run and the model diverge.
fn summary(done: &Replay) -> Result<String, Failure> {
    let (run, track, from, to) = (&done.run, &done.track, done.from_m.round() + 0.0, done.to_m);
    let (differences, sections) = (&done.differences, &done.sections);
    let missing = quantity(done.mean_force_n, "N");
    Ok(format!(
        "{run} on {track}, {from:.0} to {to:.0} m, measured minus model\n{}{}\
         mean force along the sled missing from the model: {missing}\n",
        document_text(differences)?,
        document_text(sections)?
    ))
}
