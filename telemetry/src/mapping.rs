//! `mapping.toml`, key by key, and what can be checked before its files are read.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::Error;
use crate::unit::{column_unit, conversion};

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
    /// Its files, relative to the mapping: a path in whose last part one `*` is the run's name.
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
    /// By how much its clock is late, stated instead of found: an event is this much later in it than in the runs' clock [s].
    pub delay_s: Option<f64>,
    /// Roll, pitch and yaw of the sensor box in the sled's axes [rad]: turns the accelerometer's and the gyroscope's axes
    /// together, about x first, then y, then z.
    pub rotation: Option<[f64; 3]>,
    /// Largest delay that is searched [s].
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
    /// By how much the channel is late against its logger's clock [s].
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
    /// A CSV with a column `run` and any of the others; a cell of it takes precedence.
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

impl Mapping {
    /// Reads a mapping and checks what can be checked without its files.
    ///
    /// # Errors
    /// [`Error::File`] with the line where it is no TOML or a key is unknown; [`Error::Key`].
    pub fn parse(text: &str, file: &str) -> Result<Mapping, Error> {
        let mapping: Mapping = toml::from_str(text)
            .map_err(|error| Error::file(file, error.to_string().trim_end().replace('\n', " ")))?;
        check(&mapping, file)?;
        Ok(mapping)
    }
}

/// Largest number that a key of a mapping takes; far beyond any sensor's.
const LARGEST: f64 = 1e12;

/// Values that `runs.csv` takes: what they may be, as its reader has it.
pub(crate) const INDEX_RANGES: [(&str, f64, f64); 6] = [
    ("ice_c", -60.0, 5.0),
    ("air_c", -60.0, 50.0),
    ("air_pa", 50e3, 110e3),
    ("humidity_pct", 0.0, 100.0),
    ("distance_m", 0.0, 1e8),
    ("mass_kg", 1.0, 1e5),
];

/// Checks names, ranges and units.
///
/// # Errors
/// [`Error::Key`].
pub(crate) fn check(mapping: &Mapping, file: &str) -> Result<(), Error> {
    let wrong = |key: String, found: String, expected: &str| Error::Key {
        file: file.to_string(),
        key,
        found,
        expected: expected.to_string(),
    };
    let within = |key: String, value: Option<f64>, low: f64, high: f64| match value {
        Some(value) if !(low..=high).contains(&value) => Err(wrong(
            key,
            value.to_string(),
            &format!("a number from {low} to {high}"),
        )),
        _ => Ok(()),
    };
    within("rate_hz".into(), Some(mapping.rate_hz), 1.0, 1e4)?;
    let names = mapping
        .logger
        .keys()
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    if mapping.logger.is_empty() {
        return Err(wrong(
            "logger".into(),
            "none".into(),
            "at least one table [logger.NAME]",
        ));
    }
    if mapping.channels.is_empty() {
        return Err(wrong(
            "channels".into(),
            "none".into(),
            "at least one column",
        ));
    }
    match &mapping.clock {
        None if mapping.logger.len() > 1 => {
            return Err(wrong(
                "clock".into(),
                "nothing".into(),
                &format!("the logger whose clock the runs keep, one of: {names}"),
            ));
        }
        Some(name) if !mapping.logger.contains_key(name) => {
            return Err(wrong(
                "clock".into(),
                name.clone(),
                &format!("one of: {names}"),
            ));
        }
        _ => {}
    }
    for (name, logger) in &mapping.logger {
        let key = |of: &str| format!("logger.{name}.{of}");
        plain_name(name).ok_or_else(|| wrong("logger".into(), name.clone(), PLAIN))?;
        within(key("rate_hz"), logger.rate_hz, 0.01, 1e6)?;
        within(key("delay_s"), logger.delay_s, -1e9, 1e9)?;
        within(key("largest_delay_s"), logger.largest_delay_s, 0.0, 1e5)?;
        for angle in logger.rotation.into_iter().flatten() {
            let most = std::f64::consts::TAU;
            within(key("rotation"), Some(angle), -most, most)?;
        }
        if logger.rate_hz.is_some() && logger.time.is_some() {
            return Err(wrong(
                key("rate_hz"),
                "a rate and a time channel".into(),
                "one of the two",
            ));
        }
        if logger
            .delimiter
            .is_some_and(|c| ![',', ';', '\t'].contains(&c))
        {
            let found = logger.delimiter.unwrap_or_default().to_string();
            return Err(wrong(
                key("delimiter"),
                found,
                "a comma, a semicolon or a tab",
            ));
        }
        if logger.decimal.is_some_and(|c| !['.', ','].contains(&c)) {
            let found = logger.decimal.unwrap_or_default().to_string();
            return Err(wrong(key("decimal"), found, "a point or a comma"));
        }
        if let Some(unit) = &logger.time_unit {
            conversion(unit, "s")
                .map_err(|reason| wrong(key("time_unit"), unit.clone(), &reason))?;
        }
        for (column, channel) in &logger.also {
            let at = format!("logger.{name}.also.{column}");
            check_channel(&at, column, channel, &names, mapping, &wrong)?;
            within(format!("{at}.delay_s"), channel.delay_s, -60.0, 60.0)?;
            if channel.logger.as_ref().is_some_and(|own| own != name) {
                let found = channel.logger.clone().unwrap_or_default();
                return Err(wrong(
                    format!("{at}.logger"),
                    found,
                    "nothing: it is this logger's",
                ));
            }
        }
    }
    for (column, channel) in &mapping.channels {
        let at = format!("channels.{column}");
        if column == "t_s" {
            return Err(wrong(
                at,
                "a time".into(),
                "logger.NAME.time: times are the loggers'",
            ));
        }
        check_channel(&at, column, channel, &names, mapping, &wrong)?;
        within(format!("{at}.delay_s"), channel.delay_s, -60.0, 60.0)?;
        if channel.logger.is_none() && mapping.logger.len() > 1 {
            return Err(wrong(
                format!("{at}.logger"),
                "nothing".into(),
                &format!("one of: {names}"),
            ));
        }
    }
    let index = |at: &str, values: &IndexValues| {
        for (name, low, high) in INDEX_RANGES {
            within(format!("{at}.{name}"), values.number(name), low, high)?;
        }
        for (place, value) in &values.ice_c_at {
            let key = format!("{at}.ice_c_at");
            place_of(place)
                .ok_or_else(|| wrong(key.clone(), place.clone(), "a place along the track in m"))?;
            let (_, low, high) = INDEX_RANGES[0];
            within(format!("{key}.{place}"), Some(*value), low, high)?;
        }
        Ok(())
    };
    index("index", &mapping.index)?;
    for run in &mapping.run {
        if mapping
            .run
            .iter()
            .filter(|other| other.name == run.name)
            .count()
            > 1
        {
            return Err(wrong(
                "run.name".into(),
                format!("{} twice", run.name),
                "each run once",
            ));
        }
        plain_name(&run.name).ok_or_else(|| wrong("run.name".into(), run.name.clone(), PLAIN))?;
        index(&format!("run {}: index", run.name), &run.index)?;
        let named = run.files.keys().chain(run.delay_s.keys());
        if let Some(unknown) = named
            .into_iter()
            .find(|name| !mapping.logger.contains_key(*name))
        {
            let key = format!("run {}: files or delay_s", run.name);
            return Err(wrong(key, unknown.clone(), &format!("one of: {names}")));
        }
        for (logger, delay) in &run.delay_s {
            within(
                format!("run {}: delay_s.{logger}", run.name),
                Some(*delay),
                -1e9,
                1e9,
            )?;
        }
    }
    Ok(())
}

/// A place along the track [m] as it is written in a name.
pub(crate) fn place_of(text: &str) -> Option<f64> {
    text.parse().ok().filter(|s_m: &f64| s_m.abs() < 1e6)
}

const PLAIN: &str = "letters, digits, '-', '_' and '.', not beginning with a point";

/// A name that may be a file's.
pub(crate) fn plain_name(name: &str) -> Option<&str> {
    let plain = name
        .chars()
        .all(|c| c.is_alphanumeric() || "-_. ".contains(c));
    (plain && !name.is_empty() && !name.starts_with('.') && name.len() <= 120).then_some(name)
}

fn check_channel(
    at: &str,
    column: &str,
    channel: &ChannelSource,
    names: &str,
    mapping: &Mapping,
    wrong: &dyn Fn(String, String, &str) -> Error,
) -> Result<(), Error> {
    let own = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if !column.chars().all(own) || !column.starts_with(|c: char| c.is_ascii_lowercase()) {
        return Err(wrong(
            at.into(),
            column.into(),
            "small letters, digits and '_'",
        ));
    }
    if let Some(name) = channel
        .logger
        .as_ref()
        .filter(|name| !mapping.logger.contains_key(*name))
    {
        return Err(wrong(
            format!("{at}.logger"),
            name.clone(),
            &format!("one of: {names}"),
        ));
    }
    if let Some(sign) = channel.sign.filter(|sign| sign.abs() != 1.0) {
        return Err(wrong(format!("{at}.sign"), sign.to_string(), "1 or -1"));
    }
    let numbers = [("scale", channel.scale), ("zero", channel.zero)];
    let places = channel
        .place_m
        .into_iter()
        .flatten()
        .map(|x| ("place_m", Some(x / 100.0 * LARGEST)));
    for (name, value) in numbers.into_iter().chain(places) {
        let zero = name == "scale" && value == Some(0.0);
        if value.is_some_and(|value| value.is_nan() || value.abs() > LARGEST || zero) {
            let found = value.unwrap_or_default().to_string();
            return Err(wrong(format!("{at}.{name}"), found, "a number of a sensor"));
        }
    }
    if let Some(unit) = &channel.unit {
        let target = column_unit(column);
        conversion(unit, target).map_err(|reason| {
            let expected = format!("a unit that converts to {target} ({reason})");
            wrong(format!("{at}.unit"), unit.clone(), &expected)
        })?;
    }
    Ok(())
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
