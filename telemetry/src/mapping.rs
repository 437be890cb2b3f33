//! The document `mapping.toml`, and the checks that do not need its files.

use std::collections::BTreeMap;
use std::path::PathBuf;

use kufe_sled::{CONDITIONS, RunFormat};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::Error;
use crate::unit::{column_unit, conversion};

/// A mapping: the files of recorded runs, and the conversion of their channels to columns.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "mapping.toml")]
pub struct Mapping {
    /// Rate of the imported runs [Hz].
    #[serde(default = "default_rate")]
    #[schemars(range(min = 1.0, max = 10000.0))]
    pub rate_hz: f64,
    /// File format of the imported runs: "csv" or "parquet".
    #[serde(default)]
    pub format: RunFormat,
    /// The logger whose clock is that of the runs; required with several loggers.
    pub clock: Option<String>,
    /// The loggers by name.
    #[serde(default)]
    pub logger: BTreeMap<String, LoggerFiles>,
    /// The columns of the runs with their sources; the ending of a column's name is its unit.
    #[serde(default)]
    pub channels: BTreeMap<String, ChannelSource>,
    /// Values of `runs.csv` for every run.
    #[serde(default)]
    pub index: IndexValues,
    /// Runs with other files, other values of `runs.csv` or stated delays.
    #[serde(default)]
    pub run: Vec<PlannedRun>,
}

fn default_rate() -> f64 {
    100.0
}

/// The files of one logger, and its clock.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoggerFiles {
    /// Path of its files relative to the mapping; one `*` in the last part is the run's name.
    pub files: Option<String>,
    /// Time channel; not needed for MDF 4 files, which state their times.
    pub time: Option<String>,
    /// Unit of the time channel, if the file does not state it.
    pub time_unit: Option<String>,
    /// Sample rate [Hz], if it records no time.
    #[schemars(range(min = 0.01, max = 1000000.0))]
    pub rate_hz: Option<f64>,
    /// "own": the delay of its clock is estimated from relations to other loggers; "shared": its
    /// clock is that of the runs.
    #[serde(default)]
    pub clock: ClockWord,
    /// Stated delay of its clock: time of an event in this clock less that in the runs' clock [s].
    pub delay_s: Option<f64>,
    /// Roll, pitch and yaw of the sensor box in the sled's axes [rad]: rotates the axes of
    /// accelerometer and gyroscope about x, then y, then z.
    pub rotation: Option<[f64; 3]>,
    /// Largest delay of the search [s].
    #[schemars(range(min = 0.0, max = 100000.0))]
    pub largest_delay_s: Option<f64>,
    /// Delimiter of cells of a text file, if it cannot be detected: ",", ";" or a tab.
    pub delimiter: Option<char>,
    /// Decimal separator of a text file, if it cannot be detected: "." or ",".
    pub decimal: Option<char>,
    /// Columns that another logger records too: they are used to estimate the delay and are not
    /// written.
    #[serde(default)]
    pub also: BTreeMap<String, ChannelSource>,
}

/// The clock of a logger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ClockWord {
    /// A clock of its own, with a delay.
    #[default]
    Own,
    /// The clock of the runs.
    Shared,
}

/// Source of a column: `sign * unit(scale * (value - zero))`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelSource {
    /// The channel's name in the file.
    pub from: String,
    /// The logger; required with several loggers.
    pub logger: Option<String>,
    /// The channel's unit, if the file does not state it: g, km/h, deg/s, ...
    pub unit: Option<String>,
    /// -1 for a sensor with the opposite sign.
    pub sign: Option<f64>,
    /// Size of one count in the unit.
    pub scale: Option<f64>,
    /// Reading at zero, in counts.
    pub zero: Option<f64>,
    /// Delay of the channel relative to its logger's clock [s].
    pub delay_s: Option<f64>,
    /// Time channel, if it is not that of the logger.
    pub time: Option<String>,
    /// Position of the sensor from the centre of gravity, x forward, y left, z up [m].
    pub place_m: Option<[f64; 3]>,
}

/// Values of `runs.csv` for a run.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IndexValues {
    /// CSV file with a column `run` and any of the other columns; its cells take precedence.
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
    /// Ice temperatures [degrees Celsius] by distance along the track [m]:
    /// `{ 350 = -8.2, 1100 = -9.0 }`.
    #[serde(default)]
    pub ice_c_at: BTreeMap<String, f64>,
    /// Air temperature [degrees Celsius].
    pub air_c: Option<f64>,
    /// Air pressure [Pa].
    pub air_pa: Option<f64>,
    /// Relative humidity [%].
    pub humidity_pct: Option<f64>,
    /// Distance run with the present surface finish of the runners before the run [m].
    pub distance_m: Option<f64>,
    /// Mass of the sled with its crew [kg], if it differs from the model.
    pub mass_kg: Option<f64>,
    /// Non-empty cells of the table's columns `x_NAME`.
    #[serde(skip)]
    pub covariates: BTreeMap<String, String>,
}

/// A run to import; in the mapping only runs that differ from the others are stated.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlannedRun {
    /// Name of the run and of its files.
    pub name: String,
    /// Files by logger, where no pattern matches them.
    #[serde(default)]
    pub files: BTreeMap<String, PathBuf>,
    /// Stated delays of loggers in this run [s].
    #[serde(default)]
    pub delay_s: BTreeMap<String, f64>,
    /// Values of `runs.csv` for the run.
    #[serde(default)]
    pub index: IndexValues,
}

impl Mapping {
    /// The logger of a channel.
    pub fn logger_of<'a>(&'a self, channel: &'a ChannelSource) -> &'a str {
        self.or_only(&channel.logger)
    }

    /// The logger whose clock is that of the runs.
    pub fn lead(&self) -> &str {
        self.or_only(&self.clock)
    }

    /// `name`, or the name of the first logger.
    fn or_only<'a>(&'a self, name: &'a Option<String>) -> &'a str {
        let name = name.as_ref().or_else(|| self.logger.keys().next());
        name.map_or("", String::as_str)
    }

    /// Reads a mapping and checks everything that does not need its files.
    ///
    /// # Errors
    /// [`Error::File`] with the line of invalid TOML or an unknown key; [`Error::Key`].
    pub fn parse(text: &str, file: &str) -> Result<Mapping, Error> {
        let mapping: Mapping = toml::from_str(text).map_err(|error| {
            let reason = kufe_files::broken_at(text, error.span(), error.message());
            Error::file(file, reason)
        })?;
        check(&mapping, file)?;
        Ok(mapping)
    }
}

/// Largest value of a scale or zero, far above any sensor's.
const MAX_VALUE: f64 = 1e12;

/// Largest stated delay [s].
const MAX_DELAY_S: f64 = 1e9;

/// Valid names, for messages.
const PLAIN: &str = "letters, digits, '-', '_' and '.', not beginning with a point";

/// Checks names, ranges and units.
///
/// # Errors
/// [`Error::Key`].
fn check(mapping: &Mapping, file: &str) -> Result<(), Error> {
    let names: Vec<&str> = mapping.logger.keys().map(String::as_str).collect();
    let one_of = format!("one of: {}", names.join(", "));
    let check = Check {
        mapping,
        file,
        one_of,
    };
    check.within("rate_hz".into(), Some(mapping.rate_hz), 1.0, 1e4)?;
    let (loggers, channels) = (&mapping.logger, &mapping.channels);
    let tables = "at least one table [logger.NAME]";
    check.require(!loggers.is_empty(), "logger".into(), "none", tables)?;
    let columns = "at least one column";
    check.require(!channels.is_empty(), "channels".into(), "none", columns)?;
    let lead = format!("the logger whose clock the runs keep, {}", check.one_of);
    let stated = mapping.clock.is_some() || loggers.len() < 2;
    check.require(stated, "clock".into(), "nothing", &lead)?;
    check.logger("clock".into(), mapping.clock.as_ref())?;
    for (name, logger) in loggers {
        check.logger_table(name, logger)?;
    }
    for (column, channel) in channels {
        let at = format!("channels.{column}");
        let times = "logger.NAME.time: times are the loggers'";
        check.require(column != "t_s", at.clone(), "a time", times)?;
        check.channel(&at, column, channel)?;
        let stated = channel.logger.is_some() || loggers.len() < 2;
        check.require(stated, format!("{at}.logger"), "nothing", &check.one_of)?;
    }
    check.index("index", &mapping.index)?;
    for run in &mapping.run {
        check.run(run)?;
    }
    Ok(())
}

/// Checks of one mapping, with the file name for errors.
struct Check<'a> {
    mapping: &'a Mapping,
    file: &'a str,
    /// The names of the loggers, for errors.
    one_of: String,
}

impl Check<'_> {
    fn require(
        &self,
        holds: bool,
        key: String,
        found: impl ToString,
        expected: &str,
    ) -> Result<(), Error> {
        if holds {
            return Ok(());
        }
        Err(Error::Key {
            file: self.file.to_string(),
            key,
            found: found.to_string(),
            expected: expected.to_string(),
        })
    }

    fn within(&self, key: String, value: Option<f64>, low: f64, high: f64) -> Result<(), Error> {
        let value = value.unwrap_or(low);
        let expected = format!("a number from {low} to {high}");
        self.require((low..=high).contains(&value), key, value, &expected)
    }

    fn name(&self, key: &str, name: &str) -> Result<(), Error> {
        self.require(plain_name(name).is_some(), key.into(), name, PLAIN)
    }

    /// Checks that a named logger exists.
    fn logger(&self, key: String, name: Option<&String>) -> Result<(), Error> {
        let unknown = name.filter(|name| !self.mapping.logger.contains_key(*name));
        let found = unknown.map_or("", String::as_str);
        self.require(unknown.is_none(), key, found, &self.one_of)
    }

    fn unit(&self, key: String, unit: Option<&String>, target: &str) -> Result<(), Error> {
        let Some(unit) = unit else { return Ok(()) };
        let reason = conversion(unit, target).err();
        let expected = reason.as_deref().unwrap_or_default();
        let expected = format!("a unit that converts to {target} ({expected})");
        self.require(reason.is_none(), key, unit, &expected)
    }

    fn logger_table(&self, name: &str, logger: &LoggerFiles) -> Result<(), Error> {
        let key = |of: &str| format!("logger.{name}.{of}");
        self.name("logger", name)?;
        self.within(key("rate_hz"), logger.rate_hz, 0.01, 1e6)?;
        let delay_s = logger.delay_s;
        self.within(key("delay_s"), delay_s, -MAX_DELAY_S, MAX_DELAY_S)?;
        self.within(key("largest_delay_s"), logger.largest_delay_s, 0.0, 1e5)?;
        for angle in logger.rotation.into_iter().flatten() {
            let most = std::f64::consts::TAU;
            self.within(key("rotation"), Some(angle), -most, most)?;
        }
        let both = logger.rate_hz.is_some() && logger.time.is_some();
        let found = "a rate and a time channel";
        self.require(!both, key("rate_hz"), found, "one of the two")?;
        let delimiter = logger.delimiter.unwrap_or(',');
        let known = [',', ';', '\t'].contains(&delimiter);
        let expected = "a comma, a semicolon or a tab";
        self.require(known, key("delimiter"), delimiter, expected)?;
        let decimal = logger.decimal.unwrap_or('.');
        let known = ['.', ','].contains(&decimal);
        self.require(known, key("decimal"), decimal, "a point or a comma")?;
        self.unit(key("time_unit"), logger.time_unit.as_ref(), "s")?;
        for (column, channel) in &logger.also {
            let at = key(&format!("also.{column}"));
            self.channel(&at, column, channel)?;
            let other = channel.logger.as_ref().filter(|own| *own != name);
            let found = other.map_or("", String::as_str);
            let expected = "nothing: it is this logger's";
            self.require(other.is_none(), format!("{at}.logger"), found, expected)?;
        }
        Ok(())
    }

    fn channel(&self, at: &str, column: &str, channel: &ChannelSource) -> Result<(), Error> {
        let key = |of: &str| format!("{at}.{of}");
        let own = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let plain = column.chars().all(own) && column.starts_with(|c: char| c.is_ascii_lowercase());
        self.require(plain, at.into(), column, "small letters, digits and '_'")?;
        self.logger(key("logger"), channel.logger.as_ref())?;
        let sign = channel.sign.unwrap_or(1.0);
        self.require(sign.abs() == 1.0, key("sign"), sign, "1 or -1")?;
        let places = channel.place_m.into_iter().flatten();
        let places = places.map(|x| ("place_m", x / 100.0 * MAX_VALUE));
        let scale = ("scale", channel.scale.unwrap_or(1.0));
        let zero = ("zero", channel.zero.unwrap_or(0.0));
        for (name, value) in [scale, zero].into_iter().chain(places) {
            let known = value.abs() <= MAX_VALUE && !(name == "scale" && value == 0.0);
            self.require(known, key(name), value, "a number of a sensor")?;
        }
        self.unit(key("unit"), channel.unit.as_ref(), column_unit(column))?;
        self.within(key("delay_s"), channel.delay_s, -60.0, 60.0)
    }

    fn index(&self, at: &str, values: &IndexValues) -> Result<(), Error> {
        for ((name, low, high), value) in CONDITIONS.iter().zip(values.clone().numbers()) {
            self.within(format!("{at}.{name}"), *value, *low, *high)?;
        }
        let (_, low, high) = CONDITIONS[0];
        for (place, value) in &values.ice_c_at {
            let (key, known) = (format!("{at}.ice_c_at"), place_of(place).is_some());
            self.require(known, key.clone(), place, "a place along the track in m")?;
            self.within(format!("{key}.{place}"), Some(*value), low, high)?;
        }
        Ok(())
    }

    fn run(&self, run: &PlannedRun) -> Result<(), Error> {
        let runs = self.mapping.run.iter();
        let same = runs.filter(|other| other.name == run.name).count();
        let found = format!("{} twice", run.name);
        self.require(same == 1, "run.name".into(), found, "each run once")?;
        self.name("run.name", &run.name)?;
        self.index(&format!("run {}: index", run.name), &run.index)?;
        for name in run.files.keys().chain(run.delay_s.keys()) {
            self.logger(format!("run {}: files or delay_s", run.name), Some(name))?;
        }
        for (logger, delay) in &run.delay_s {
            let key = format!("run {}: delay_s.{logger}", run.name);
            self.within(key, Some(*delay), -MAX_DELAY_S, MAX_DELAY_S)?;
        }
        Ok(())
    }
}

/// Reads a distance along the track [m] from a name.
pub(crate) fn place_of(text: &str) -> Option<f64> {
    text.parse().ok().filter(|s_m: &f64| s_m.abs() < 1e6)
}

/// The name, if it is a valid file name.
pub(crate) fn plain_name(name: &str) -> Option<&str> {
    let mut letters = name.chars();
    let plain = letters.all(|c| c.is_alphanumeric() || "-_. ".contains(c));
    (plain && !name.is_empty() && !name.starts_with('.') && name.len() <= 120).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_is_a_mapping_with_its_comments_and_without() {
        let text = crate::MAPPING_EXAMPLE;
        let mapping = Mapping::parse(text, "mapping.toml").unwrap();
        assert_eq!(mapping.lead(), "imu");
        assert_eq!(mapping.channels.len(), kufe_sled::COLUMNS.len());
        // Every key in a comment is one.
        let keys = text
            .replace("# rate_hz = 500", "#- rate_hz = 500")
            .replace("# a column", "#- a column");
        let all: Vec<String> = keys
            .lines()
            .map(|line| match line.strip_prefix("# ") {
                Some(rest) if rest.contains(" = ") || rest.starts_with("[[") => rest.to_string(),
                _ => line.to_string(),
            })
            .filter(|line| {
                !line.contains("kufe runs init")
                    && !line.contains("Its clock is")
                    && !line.contains("A column is")
            })
            .collect();
        let all = Mapping::parse(&all.join("\n"), "mapping.toml").unwrap();
        assert_eq!(all.run.len(), 1);
        assert_eq!(all.logger["gps"].also.len(), 1);
    }

    #[test]
    fn unknown_keys_and_values_out_of_range_are_named() {
        for (key, value, said) in [
            (
                "rate_hz = 100.0",
                "rate_hz = 0.5",
                "rate_hz: found 0.5, expected a number from 1 to 10000",
            ),
            ("rate_hz = 100.0", "rate_hz = nan", "rate_hz: found NaN"),
            (
                "clock = \"imu\"",
                "clock = \"mu\"",
                "clock: found mu, expected one of: gps, imu",
            ),
            (
                "time_unit = \"ms\"",
                "time_unit = \"kg\"",
                "logger.gps.time_unit: found kg, expected",
            ),
            (
                "ice_c = -8.0",
                "ice_c = 20.0",
                "index.ice_c: found 20, expected a number from -60 to 5",
            ),
            (
                "sign = -1",
                "sign = -10",
                "channels.ay_mps2.sign: found -10, expected 1 or -1",
            ),
            (
                "v_mps = { logger = \"gps\"",
                "v_mps = { logger = \"gsp\"",
                "channels.v_mps.logger: found gsp, expected one of",
            ),
            ("[index] ", "[indecks] ", "indecks"),
            (
                "# [[run]]",
                "[[run]]\nname = \"a\"\n[[run]]\nname = \"a\"\n#",
                "run.name: found a twice, expected each run once",
            ),
            (
                "scale = 12.0",
                "scale = 0.0",
                "channels.delta_rad.scale: found 0",
            ),
            (
                "unit = \"km/h\"",
                "unit = \"kg\"",
                "channels.v_mps.unit: found kg, expected a unit that converts to m/s",
            ),
        ] {
            let text = crate::MAPPING_EXAMPLE.replacen(key, value, 1);
            assert_ne!(text, crate::MAPPING_EXAMPLE, "{key}");
            let error = Mapping::parse(&text, "mapping.toml")
                .unwrap_err()
                .to_string();
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
    }
}
