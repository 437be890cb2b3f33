//! Documents made of recorded and simulated runs: fit, evaluation, validation, replay and simulation.

use std::collections::BTreeSet;
use std::path::PathBuf;

use kufe_sled::{
    EnergyBalance, FitResult, Group, OutsideTable, Replay, RunEvaluation, RunValidation,
    SampleCoverage, TrackValidation,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a result made of recorded runs states of them.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RunsUsed {
    /// Runs left out and why.
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
    /// What the intervals of the groups are.
    pub interval: String,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

/// `validation.json`: measured and modelled lateral force.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "validation.json")]
pub struct Validation {
    /// Run by run.
    pub runs: Vec<RunValidation>,
    /// Track by track.
    pub tracks: Vec<TrackValidation>,
    /// Runs left out because the laws were fitted to them.
    pub left_out_as_fitted: BTreeSet<String>,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

/// `simulation.json` of a replay: a measured run driven again by the model.
#[derive(Clone, Debug, Serialize)]
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
