//! `mapping.toml`, key by key.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

/// A mapping: where runs are recorded, and how their channels become columns.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "mapping.toml")]
pub struct Mapping {
    /// Rate of the imported runs [Hz].
    #[serde(default = "default_rate")]
    #[schemars(range(min = 1.0, max = 10000.0))]
    pub rate_hz: f64,
    /// How the runs are written: "csv" or "parquet".
    #[serde(default)]
    pub format: RunFormatWord,
    /// The logger whose clock the runs keep; needed where there are several.
    pub clock: Option<String>,
    /// The loggers by name.
    #[serde(default)]
    pub logger: BTreeMap<String, LoggerFiles>,
    /// The columns of the runs, and what each is made of; a column's unit is what its name ends in.
    #[serde(default)]
    pub channels: BTreeMap<String, ChannelSource>,
    /// What `runs.csv` says of every run.
    #[serde(default)]
    pub index: IndexValues,
    /// Runs of their own: other files, other lines of `runs.csv`, delays stated by hand.
    #[serde(default)]
    pub run: Vec<RunTable>,
}

fn default_rate() -> f64 {
    100.0
}

/// The form of the imported runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RunFormatWord {
    /// Text.
    #[default]
    Csv,
    /// Parquet.
    Parquet,
}

/// The files of one logger, and its clock.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoggerFiles {
    /// Its files, relative to the mapping: a path in whose last part one `*` stands for the run's name.
    pub files: Option<String>,
    /// The channel that holds its time; an MDF 4 file has its own.
    pub time: Option<String>,
    /// The time channel's unit, where the file does not say it.
    pub time_unit: Option<String>,
    /// Rate of its samples [Hz], where it records no time.
    #[schemars(range(min = 0.01, max = 1000000.0))]
    pub rate_hz: Option<f64>,
    /// "own": its clock's delay is found from what its channels share with others'; "shared": its clock is the runs'.
    #[serde(default)]
    pub clock: ClockWord,
    /// By how much its clock is late, stated instead of found: an event stands in it this much later than in the runs' clock [s].
    pub delay_s: Option<f64>,
    /// Largest delay that is looked for [s].
    #[schemars(range(min = 0.0, max = 100000.0))]
    pub largest_delay_s: Option<f64>,
    /// Between two cells of a text file, where it cannot be found out: ",", ";" or a tab.
    pub delimiter: Option<char>,
    /// Before decimals in a text file, where it cannot be found out: "." or ",".
    pub decimal: Option<char>,
    /// Columns that it records besides another logger: they serve to find its delay and are not written.
    #[serde(default)]
    pub also: BTreeMap<String, ChannelSource>,
}

/// Whose clock a logger has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ClockWord {
    /// One of its own.
    #[default]
    Own,
    /// That of the runs.
    Shared,
}

/// What a column is made of: `sign * unit(scale * (value - zero))`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelSource {
    /// The channel's name in the file.
    pub from: String,
    /// The logger; needed where there are several.
    pub logger: Option<String>,
    /// The channel's unit, where the file does not say it: g, km/h, deg/s, ...
    pub unit: Option<String>,
    /// -1 where the sensor counts the other way round.
    pub sign: Option<f64>,
    /// What one count is in the unit.
    pub scale: Option<f64>,
    /// What the sensor reads at zero, in its own counts.
    pub zero: Option<f64>,
    /// By how much the channel is late beside its logger's clock [s].
    pub delay_s: Option<f64>,
    /// The channel that holds its time, where it is not the logger's.
    pub time: Option<String>,
    /// The sensor's place from the centre of gravity, x forward, y left, z up [m].
    pub place_m: Option<[f64; 3]>,
}

/// What `runs.csv` says of a run.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IndexValues {
    /// A CSV with a column `run` and any of the others; a cell of it stands before what is said here.
    pub table: Option<PathBuf>,
    /// Name of the track.
    pub track: Option<String>,
    /// Driver.
    pub driver: Option<String>,
    /// Driver's class.
    pub driver_class: Option<String>,
    /// Session (a day, a set-up).
    pub session: Option<String>,
    /// Ice temperature [degrees Celsius].
    pub ice_c: Option<f64>,
    /// Ice temperatures [degrees Celsius] by their place along the track [m]: `{ 350 = -8.2, 1100 = -9.0 }`.
    #[serde(default)]
    pub ice_c_at: BTreeMap<String, f64>,
    /// Air temperature [degrees Celsius].
    pub air_c: Option<f64>,
    /// Air pressure [Pa].
    pub air_pa: Option<f64>,
    /// Relative humidity [%].
    pub humidity_pct: Option<f64>,
    /// Distance run on this finish of the runners before the run [m].
    pub distance_m: Option<f64>,
    /// Mass of the sled with its crew [kg], where it is not the model's.
    pub mass_kg: Option<f64>,
}

/// One run that differs from the others.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunTable {
    /// The run's name.
    pub name: String,
    /// Its files by logger, where no pattern finds them.
    #[serde(default)]
    pub files: BTreeMap<String, PathBuf>,
    /// Delays of loggers in this run, stated instead of found [s].
    #[serde(default)]
    pub delay_s: BTreeMap<String, f64>,
    /// What `runs.csv` says of it.
    #[serde(default)]
    pub index: IndexValues,
}

impl Mapping {
    /// The logger that a channel is in.
    pub fn logger_of<'a>(&'a self, channel: &'a ChannelSource) -> &'a str {
        let only = || self.logger.keys().next().map_or("", String::as_str);
        channel.logger.as_deref().unwrap_or_else(only)
    }

    /// The logger whose clock the runs keep.
    pub fn lead(&self) -> &str {
        let only = || self.logger.keys().next().map_or("", String::as_str);
        self.clock.as_deref().unwrap_or_else(only)
    }
}
