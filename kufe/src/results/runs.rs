//! Documents of recorded, simulated and imported runs.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::PathBuf;

use kufe_sled::friction::{Interval, LateralFit};
use kufe_sled::sample_data::{Planned, sample_drivers};
use kufe_sled::{
    AlignedRun, Driver, DriverLosses, Examination, FitResult, Group, OutsideTable, Replay,
    RunEvaluation, RunValidation, SampleCoverage, TrackEstimate, TrackValidation, WallContact,
    groups, losses_by_driver,
};
use kufe_telemetry::{ExcludedRun, Note};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plot::quantity;
use crate::results::datum::{Data, Datum};
use crate::results::record::write_csv;

/// Exclusions, gaps and table limits of the runs of a result.
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
    /// Laws of both runners with the data that they were fitted to.
    #[serde(flatten)]
    pub fit: FitResult,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

impl LateralFitDocument {
    /// The fitted laws, one sentence per runner.
    pub fn headline(&self) -> String {
        let between = |x: &Interval, unit: &str| {
            let amount = |value| quantity(value, unit);
            let ends = x.low.zip(x.high);
            let ends = ends.map(|(low, high)| format!(" ({} to {})", amount(low), amount(high)));
            amount(x.value) + &ends.unwrap_or_default()
        };
        let sentence = |(runner, fit): (&str, &LateralFit)| {
            format!(
                "{runner} runner: stiffness {}, largest grip {}, r.m.s. residual {}.",
                between(&fit.k_n_per_rad, "N/rad"),
                between(&fit.mu_zeta, ""),
                quantity(fit.residual_rms_n, "N"),
            )
        };
        let runners = [("Front", &self.fit.front), ("Rear", &self.fit.rear)];
        runners.map(sentence).join(" ")
    }
}

/// `evaluation.json`: losses of each run over a straight glide.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "evaluation.json")]
pub struct Evaluation {
    /// Run by run.
    pub runs: Vec<RunEvaluation>,
    /// Means over drivers, classes and tracks.
    pub groups: Vec<Group>,
    /// Losses of each driver on each track by place, in seconds.
    #[serde(default)]
    pub drivers: Vec<DriverLosses>,
    /// Definition of the intervals of the groups.
    pub interval: String,
    /// The runs.
    #[serde(flatten)]
    pub used: RunsUsed,
}

impl Evaluation {
    /// The document of evaluated runs; `seed` is that of the bootstrap intervals.
    pub fn new(runs: Vec<RunEvaluation>, used: RunsUsed, seed: u64) -> Self {
        Evaluation {
            groups: groups(&runs, seed),
            drivers: losses_by_driver(&runs),
            interval: "95 % of the mean, bootstrap over runs".to_owned(),
            runs,
            used,
        }
    }
}

/// A column of numbers of `evaluation.csv`.
type Column = (&'static str, fn(&RunEvaluation) -> f64);

/// The columns after the names of the run, track, driver, class and session.
const COLUMNS: [Column; 12] = [
    ("time_s", |run| run.time_s),
    ("e_tot_loss_j", |run| run.e_tot_loss_j),
    ("increase_front", |run| run.increase_front),
    ("increase_rear", |run| run.increase_rear),
    ("increase_aero", |run| run.increase_aero),
    ("increase_total", |run| run.increase_total),
    ("steering_above_2deg", |run| run.steering.share_above_2deg),
    ("steering_above_4deg", |run| run.steering.share_above_4deg),
    ("slip_front_above_2deg", |run| {
        run.slip_front.share_above_2deg
    }),
    ("slip_front_above_4deg", |run| {
        run.slip_front.share_above_4deg
    }),
    ("slip_rear_above_2deg", |run| run.slip_rear.share_above_2deg),
    ("slip_rear_above_4deg", |run| run.slip_rear.share_above_4deg),
];

/// Writes `evaluation.csv`, one row per run.
///
/// A name that a spreadsheet would read as a formula is preceded by an apostrophe, which marks text
/// in spreadsheets.
///
/// # Errors
/// Those of the writer.
pub fn write_evaluation_csv(writer: impl Write, runs: &[RunEvaluation]) -> std::io::Result<()> {
    let rows = runs.iter().map(|run| {
        let names = [
            ("run", &run.run),
            ("track", &run.track),
            ("driver", &run.driver),
            ("driver_class", &run.driver_class),
            ("session", &run.session),
        ];
        let names = names.map(|(key, name)| (key.to_owned(), Datum::Text(no_formula(name))));
        let numbers = COLUMNS.map(|(key, value)| (key.to_owned(), Datum::Number(value(run))));
        names.into_iter().chain(numbers).collect()
    });
    write_csv(writer, &rows.collect::<Vec<Data>>())
}

fn no_formula(name: &str) -> String {
    let mark = if name.starts_with(['=', '+', '-', '@']) {
        "'"
    } else {
        ""
    };
    format!("{mark}{name}")
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

impl Validation {
    /// The errors of the lateral force in one sentence.
    pub fn headline(&self) -> String {
        let errors = |track: &TrackValidation| {
            let [model, braghin] =
                [track.rmse_n, track.rmse_braghin_n].map(|force| quantity(force, "N"));
            let (name, runs) = (&track.track, track.runs);
            format!("{name} {model} over {runs} runs (Braghin's law: {braghin})")
        };
        let tracks: Vec<String> = self.tracks.iter().map(errors).collect();
        format!("R.m.s. error of the lateral force: {}.", tracks.join("; "))
    }
}

/// `simulation.json` of a replay: a measured run driven again by the model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "simulation.json of a replay")]
pub struct ReplayResult<'a> {
    /// Comparison of the measured and the simulated run.
    pub replay: &'a Replay,
    /// File of the measured run.
    pub measured: PathBuf,
    /// Whether the model reached the end of the run.
    pub finished: bool,
    /// Ratio of the error of the energy balance to the converted energy.
    pub energy_balance_relative_error: f64,
    /// Tables of the model that do not span every sample.
    pub outside_tables: Vec<OutsideTable>,
    /// Version of the program.
    pub version: String,
}

impl<'a> ReplayResult<'a> {
    /// The document of a replay; `measured` is the file of the run.
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
    /// Ratio of simulated time to wall time.
    pub times_real_time: f64,
    /// Version of the program.
    pub version: String,
}

/// One simulated run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct SimulatedRun {
    /// Name of the run.
    pub run: String,
    /// Seed of the noise.
    pub seed: u64,
    /// Whether it reached the finish.
    pub finished: bool,
    /// Run time [s].
    pub time_s: f64,
    /// Ratio of the error of the energy balance to the converted energy.
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

fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// `check.json`: an examination of recorded runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "check.json")]
pub struct RunCheck {
    /// Index of the runs.
    pub index: String,
    /// Number of runs with a proven fault.
    pub wrong: usize,
    /// Run by run, the worst first.
    pub runs: Vec<Examination>,
    /// Version of the program.
    pub version: String,
}

impl RunCheck {
    /// The document of the examined runs of an index.
    pub fn new(index: impl Into<String>, runs: Vec<Examination>) -> Self {
        RunCheck {
            index: index.into(),
            wrong: runs.iter().filter(|run| run.is_wrong()).count(),
            runs,
            version: version(),
        }
    }
}

/// `align.json`: runs aligned to a common distance along their track.
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
    /// Whether the runs are aligned with a survey; otherwise with one another.
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
    /// Standard error of the slope [rad].
    pub slope_sd_rad: f64,
    /// Standard error of the curvature [1/m].
    pub curvature_sd_1pm: f64,
    /// Standard error of the bank angle [rad].
    pub bank_sd_rad: f64,
}

impl TrackErrors {
    /// Errors of an estimated track.
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

/// `truth.json`: the true parameters of the sample runs.
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
    /// Parameters of the driver's steering.
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
    /// The document of a plan of runs.
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

/// `import.json`: the imported runs.
#[derive(Clone, Debug, Serialize)]
pub struct ImportList {
    /// The mapping's file.
    pub mapping: String,
    /// Version of the program.
    pub version: String,
    /// Files that were written.
    pub files: Vec<String>,
    /// Run by run.
    pub runs: Vec<ImportedRun>,
    /// Runs that are not imported, with the reason.
    pub excluded: Vec<ExcludedRun>,
}

/// One imported run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ImportedRun {
    /// Its name.
    pub run: String,
    /// Its length [s].
    pub seconds: f64,
    /// Samples by channel.
    pub samples: BTreeMap<String, SampleCount>,
    /// Number of rows without a value by channel.
    pub missing_rows: BTreeMap<String, usize>,
    /// Estimated clock delays by logger.
    pub delays: BTreeMap<String, FoundDelay>,
    /// Further remarks.
    pub remarks: Vec<String>,
}

/// Number of samples of a channel.
#[derive(Clone, Debug, Serialize)]
pub struct SampleCount {
    /// Number that follows from its rate.
    pub expected: usize,
    /// Number of samples with a value.
    pub read: usize,
}

/// The estimated delay of a logger's clock.
#[derive(Clone, Debug, Serialize)]
pub struct FoundDelay {
    /// Delay [s].
    pub delay_s: f64,
    /// Standard error of the delay [s].
    pub delay_sd_s: Option<f64>,
    /// Further delays that the estimate includes.
    pub delay_includes: Option<&'static str>,
}

impl ImportedRun {
    /// The entry of a run from the note of its import.
    pub fn of(note: &Note) -> ImportedRun {
        let mut imported = ImportedRun {
            run: note.run.clone(),
            seconds: note.rows as f64 / note.rate_hz,
            remarks: note.remarks.clone(),
            ..ImportedRun::default()
        };
        for (name, channel) in &note.channels {
            let count = SampleCount {
                expected: channel.expected_samples,
                read: channel.samples,
            };
            imported.samples.insert(name.clone(), count);
            if channel.missing_rows > 0 {
                let rows = channel.missing_rows;
                imported.missing_rows.insert(name.clone(), rows);
            }
        }
        let clocks = note
            .loggers
            .iter()
            .map(|(name, logger)| (name, &logger.clock));
        for (name, clock) in clocks.filter(|(_, clock)| clock.source == "found") {
            let delay = FoundDelay {
                delay_s: clock.delay_s,
                delay_sd_s: clock.delay_sd_s,
                delay_includes: clock.delay_includes,
            };
            imported.delays.insert(name.clone(), delay);
        }
        imported
    }
}

#[cfg(test)]
mod tests {
    use super::no_formula;

    #[test]
    fn no_name_is_a_formula_in_a_spreadsheet() {
        for (name, cell) in [
            ("=cmd()", "'=cmd()"),
            ("@SUM(1)", "'@SUM(1)"),
            ("A-1", "A-1"),
        ] {
            assert_eq!(no_formula(name), cell);
        }
    }
}
