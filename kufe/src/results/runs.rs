//! Documents of recorded and simulated runs.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use kufe_sled::sample_data::{Planned, sample_drivers};
use kufe_sled::{
    AlignedRun, Driver, DriverLosses, EnergyBalance, Examination, FitResult, Group, OutsideTable,
    Replay, RunEvaluation, RunValidation, SampleCoverage, TrackEstimate, TrackValidation,
    WallContact,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::record::write_csv;

/// What a result made of recorded runs states of them.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RunsUsed {
    /// Excluded runs with the reason.
    pub left_out: Vec<String>,
    /// Tables of the model that do not span every sample.
    pub outside_tables: Vec<OutsideTable>,
    /// Runs with gaps, and how much of them takes part.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gaps: Vec<SampleCoverage>,
    /// Version of the program.
    pub version: String,
}

/// `fit.json`: lateral friction of both runners.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "fit.json")]
pub struct LateralFitDocument {
    /// Laws of both runners, and what they rest on.
    #[serde(flatten)]
    pub fit: FitResult,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

/// `evaluation.json`: losses of each run over a straight glide.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "evaluation.json")]
pub struct Evaluation {
    /// Run by run.
    pub runs: Vec<RunEvaluation>,
    /// Drivers, classes and tracks.
    pub groups: Vec<Group>,
    /// Where each driver loses on each track, and how many seconds.
    #[serde(default)]
    pub drivers: Vec<DriverLosses>,
    /// What the intervals of the groups are.
    pub interval: String,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

/// A row of `evaluation.csv`.
#[derive(Serialize)]
struct EvaluationRow<'a> {
    run: &'a str,
    track: &'a str,
    driver: &'a str,
    driver_class: &'a str,
    session: &'a str,
    time_s: f64,
    e_tot_loss_j: f64,
    increase_front: f64,
    increase_rear: f64,
    increase_aero: f64,
    increase_total: f64,
    steering_above_2deg: f64,
    steering_above_4deg: f64,
    slip_front_above_2deg: f64,
    slip_front_above_4deg: f64,
    slip_rear_above_2deg: f64,
    slip_rear_above_4deg: f64,
}

/// Writes `evaluation.csv`: a row a run.
///
/// # Errors
/// Those of the writer.
pub fn write_evaluation_csv(writer: impl Write, runs: &[RunEvaluation]) -> std::io::Result<()> {
    let rows = runs.iter().map(|run| EvaluationRow {
        run: &run.run,
        track: &run.track,
        driver: &run.driver,
        driver_class: &run.driver_class,
        session: &run.session,
        time_s: run.time_s,
        e_tot_loss_j: run.e_tot_loss_j,
        increase_front: run.increase_front,
        increase_rear: run.increase_rear,
        increase_aero: run.increase_aero,
        increase_total: run.increase_total,
        steering_above_2deg: run.steering.share_above_2deg,
        steering_above_4deg: run.steering.share_above_4deg,
        slip_front_above_2deg: run.slip_front.share_above_2deg,
        slip_front_above_4deg: run.slip_front.share_above_4deg,
        slip_rear_above_2deg: run.slip_rear.share_above_2deg,
        slip_rear_above_4deg: run.slip_rear.share_above_4deg,
    });
    write_csv(writer, &rows.collect::<Vec<_>>())
}

/// `validation.json`: measured and modelled lateral force.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "validation.json")]
pub struct Validation {
    /// Run by run.
    pub runs: Vec<RunValidation>,
    /// Track by track.
    pub tracks: Vec<TrackValidation>,
    /// Runs excluded because the laws were fitted to them.
    pub left_out_as_fitted: BTreeSet<String>,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

/// `simulation.json` of a replay: a measured run driven again by the model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "simulation.json of a replay")]
pub struct ReplayResult<'a> {
    /// Both runs compared.
    pub replay: &'a Replay,
    /// File of the measured run.
    pub measured: PathBuf,
    /// Whether the model came to the run's end.
    pub finished: bool,
    /// Error of the energy balance over the energy turned over.
    pub energy_balance_relative_error: f64,
    /// Tables of the model that do not span every sample.
    pub outside_tables: Vec<OutsideTable>,
    /// Version of the program.
    pub version: String,
}

impl<'a> ReplayResult<'a> {
    /// Of a replay of the run in this file.
    pub fn new(replay: &'a Replay, measured: PathBuf, outside_tables: Vec<OutsideTable>) -> Self {
        ReplayResult {
            replay,
            measured,
            finished: replay.stopped.is_none(),
            energy_balance_relative_error: replay.simulated.energy.relative_error(),
            outside_tables,
            version: version(),
        }
    }
}

/// `simulation.json`: simulated runs.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "simulation.json")]
pub struct Simulation {
    /// Run by run.
    pub runs: Vec<SimulatedRun>,
    /// Track.
    pub track: String,
    /// Driver.
    pub driver: String,
    /// Simulated time over the time that it took.
    pub times_real_time: f64,
    /// Version of the program.
    pub version: String,
}

impl Simulation {
    /// Of runs that took `seconds` to simulate `simulated_s`.
    pub fn new(
        runs: Vec<SimulatedRun>,
        track: &str,
        driver: &str,
        simulated_s: f64,
        seconds: f64,
    ) -> Self {
        Simulation {
            runs,
            track: track.to_owned(),
            driver: driver.to_owned(),
            times_real_time: simulated_s / seconds,
            version: version(),
        }
    }
}

/// One simulated run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct SimulatedRun {
    /// Name of the run.
    pub run: String,
    /// Seed of the noise.
    pub seed: u64,
    /// Whether it came to the finish.
    pub finished: bool,
    /// Run time [s].
    pub time_s: f64,
    /// Error of the energy balance over the energy turned over.
    pub energy_balance_relative_error: f64,
    /// Work of gravity [J].
    pub gravity_j: f64,
    /// Work of the ice [J].
    pub ice_j: f64,
    /// Work of the air [J].
    pub air_j: f64,
    /// Tables of the model that do not span every sample.
    pub outside_tables: Vec<OutsideTable>,
}

impl SimulatedRun {
    /// A run with its energies.
    pub fn new(
        run: &kufe_sled::Run,
        seed: u64,
        finished: bool,
        energy: &EnergyBalance,
        outside_tables: Vec<OutsideTable>,
    ) -> Self {
        SimulatedRun {
            run: run.entry.run.clone(),
            seed,
            finished,
            time_s: (run.len() - 1) as f64 * run.dt_s,
            energy_balance_relative_error: energy.relative_error(),
            gravity_j: energy.gravity_j,
            ice_j: energy.ice_j,
            air_j: energy.air_j,
            outside_tables,
        }
    }
}

fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// `check.json`: an examination of recorded runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "check.json")]
pub struct RunCheck {
    /// Index of the runs.
    pub index: String,
    /// Runs in which something is provably wrong.
    pub wrong: usize,
    /// Run by run, the worst first.
    pub runs: Vec<Examination>,
    /// Version of the program.
    pub version: String,
}

impl RunCheck {
    /// Of the examined runs of an index.
    pub fn new(index: impl Into<String>, runs: Vec<Examination>) -> Self {
        RunCheck {
            index: index.into(),
            wrong: runs.iter().filter(|run| run.is_wrong()).count(),
            runs,
            version: version(),
        }
    }
}

/// `align.json`: runs on one distance along their track.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "align.json")]
pub struct Alignment {
    /// Index of the runs.
    pub index: String,
    /// Track by track.
    pub tracks: Vec<AlignedTrack>,
    /// Version of the program.
    pub version: String,
    /// Runs with gaps, and how much of them takes part.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gaps: Vec<SampleCoverage>,
}

/// The runs of one track.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AlignedTrack {
    /// Name of the track.
    pub track: String,
    /// Whether the runs are aligned with a survey; else with one another.
    pub surveyed: bool,
    /// Run by run.
    pub runs: Vec<AlignedRun>,
    /// Errors of the track where it is estimated from the runs.
    pub estimate: Option<TrackErrors>,
}

/// Extent and standard errors of an estimated track, root mean squares along it.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct TrackErrors {
    /// Start [m].
    pub from_m: f64,
    /// End [m].
    pub to_m: f64,
    /// Of the slope [rad].
    pub slope_sd_rad: f64,
    /// Of the curvature [1/m].
    pub curvature_sd_1pm: f64,
    /// Of the bank [rad].
    pub bank_sd_rad: f64,
}

impl TrackErrors {
    /// Of an estimate.
    pub fn of(estimate: &TrackEstimate) -> Self {
        let mean = |sd: &[f64]| (sd.iter().map(|x| x * x).sum::<f64>() / sd.len() as f64).sqrt();
        let [slope_sd_rad, curvature_sd_1pm, bank_sd_rad] =
            estimate.sd.each_ref().map(|sd| mean(sd));
        let s = &estimate.track.s_m;
        TrackErrors {
            from_m: s[0],
            to_m: s[s.len() - 1],
            slope_sd_rad,
            curvature_sd_1pm,
            bank_sd_rad,
        }
    }
}

/// `truth.json`: what the sample runs were driven with.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "truth.json")]
pub struct SampleTruth {
    /// Seed of the data set.
    pub seed: u64,
    /// The model.
    pub model: String,
    /// The drivers.
    pub drivers: Vec<SampleDriver>,
    /// Run by run.
    pub runs: Vec<SampleRun>,
    /// Version of the program.
    pub version: String,
}

/// A driver of the sample runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SampleDriver {
    /// Name.
    pub driver: String,
    /// Class.
    pub class: String,
    /// Number of runs.
    pub runs: usize,
    /// How the driver steers.
    #[serde(flatten)]
    pub driving: Driver,
}

/// One sample run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SampleRun {
    /// Name of the run.
    pub run: String,
    /// Track.
    pub track: String,
    /// Session.
    pub session: String,
    /// Seed of driver and sensors.
    pub seed: u64,
    /// Speed at the start [m/s].
    pub start_speed_mps: f64,
    /// Contacts with walls, which the model does not have.
    pub wall_contacts: Vec<WallContact>,
}

impl SampleTruth {
    /// Of a plan of runs.
    pub fn new(seed: u64, plan: &[Planned]) -> Self {
        let drivers = sample_drivers().iter().map(|driver| SampleDriver {
            driver: driver.name.clone(),
            class: driver.class.clone(),
            runs: driver.runs,
            driving: driver.driving,
        });
        let runs = plan.iter().map(|run| SampleRun {
            run: run.run.clone(),
            track: run.track.to_string(),
            session: run.session.to_string(),
            seed: run.options.seed,
            start_speed_mps: run.options.start_speed_mps,
            wall_contacts: run.options.contacts.clone(),
        });
        SampleTruth {
            seed,
            model: "model.toml, and the contacts with walls that each run lists here".to_owned(),
            drivers: drivers.collect(),
            runs: runs.collect(),
            version: version(),
        }
    }
}
