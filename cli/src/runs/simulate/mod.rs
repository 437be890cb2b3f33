//! `kufe simulate`: a sled driven down a track, recorded like a measured run.

mod drive;
mod replay;
mod sample;

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::simulate::stated_conditions;
use kufe_sled::Conditions;

use crate::terminal::Global;

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
    /// Which run of the runs.csv
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
    /// Ice temperature [degrees Celsius], where the track states no ice_c
    #[arg(long, value_name = "CELSIUS", default_value_t = -8.0, allow_negative_numbers = true)]
    pub ice_c: f64,
    /// Air temperature [degrees Celsius]
    #[arg(
        long,
        value_name = "CELSIUS",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub air_c: f64,
    /// Air pressure [Pa]
    #[arg(long, value_name = "PA", default_value_t = 95_000.0)]
    pub air_pa: f64,
    /// Relative humidity [%], for effects that need it; else from the model's [conditions]
    #[arg(long, value_name = "PCT")]
    pub humidity_pct: Option<f64>,
    /// Distance run on this finish of the runners before the run [m], for effects that need it;
    /// else from the model's [conditions]
    #[arg(long, value_name = "METRES")]
    pub distance_m: Option<f64>,
    /// Name of the session in runs.csv
    #[arg(long, default_value = "1")]
    pub session: String,
}

impl Args {
    /// Ice and air as the options state them.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a value out of range.
    pub fn conditions(&self) -> Result<Conditions, Failure> {
        let stated = [
            Some(self.ice_c),
            Some(self.air_c),
            Some(self.air_pa),
            self.humidity_pct,
            self.distance_m,
            None,
        ];
        stated_conditions(stated)
    }
}

/// Simulates and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match (&args.sample_data, &args.model, &args.track) {
        (None, Some(model), Some(track)) if args.replay.is_some() => {
            replay::run(args, model, track, global)
        }
        (Some(folder), model, _) => sample::run(args, folder, model.as_deref(), global),
        (None, Some(model), Some(track)) => drive::run(args, model, track, global),
        _ => Err(Failure::Usage(
            "a model and a track are needed, or --sample-data".to_string(),
        )),
    }
}
